// The sizes of points after updates: those that stay keep theirs.

#include "pcm/cache/l2_cache.h"
#include "pcm/point_cloud.h"
#include "pcm/query/edit_cursor.h"
#include "pcm/tree/point_size.h"
#include "pcm/update/append.h"
#include "pcm/update/clone.h"
#include "pcm/update/compact.h"
#include "pcm/update/erase.h"
#include "pcm/update/repair.h"
#include "pcm/update/tree_changes.h"
#include "tests/sanitizers.h"
#include "tests/update/model.h"

#include <map>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// By position and time, which is random and so different for all points.
using Sizes = std::map<std::pair<Vec3i, double>, std::uint8_t>;

Sizes sizes_of(const Tree& tree)
{
    Sizes sizes;
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        const Chunk chunk = tree.read_chunk(id, ColumnSet::whole(tree.info().schema));
        for (std::uint32_t i = 0; i < chunk.points; ++i)
            sizes[{chunk.positions->grid(i), chunk.attributes[2]->value(i)}] = chunk.sizes->as<std::uint8_t>()[i];
    }
    EXPECT_EQ(sizes.size(), tree.info().points);
    return sizes;
}

std::set<int> codes_of(const Sizes& sizes)
{
    std::set<int> codes;
    for (const auto& entry : sizes) codes.insert(entry.second);
    return codes;
}

// Those of `old` that are in `now` too. All of them, or the test fails, unless some were deleted.
std::size_t expect_kept(const Sizes& old, const Sizes& now)
{
    std::size_t kept = 0, wrong = 0;
    for (const auto& [point, size] : old)
        if (const auto found = now.find(point); found != now.end()) {
            ++kept;
            wrong += found->second != size;
        }
    EXPECT_EQ(wrong, 0u);
    return kept;
}

class SizesOfTree : public testing::Test {
protected:
    SizesOfTree()
    {
        build(surface(20000, 0, 0, 100, 17), path_);
        sizes_ = sizes_of(*Tree::open(path_));
    }
    Sizes now() const
    {
        const VerifyReport verified = verify_tree(path_, 1);
        EXPECT_TRUE(verified.faults.empty()) << verified.faults.front();
        return sizes_of(*Tree::open(path_));
    }
    void append(std::uint64_t seed, unsigned threads = 2) const
    {
        const MemoryCloud cloud = surface(8000, 50, 50, 80, seed);
        MemoryReader reader(cloud);
        AppendOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        options.threads = threads;
        append_points(path_, reader, {"more.las"}, options);
    }
    void erase(const std::string& condition) const
    {
        Selection selection;
        selection.where.push_back(parse_condition(condition));
        EraseOptions options;
        options.threads = 2;
        EXPECT_GT(erase_points(path_, selection, options).points_deleted, 0u);
    }
    // Writes all chunks again as they were before sizes were kept.
    void forget_sizes() const
    {
        TreeChanges changes(path_);
        for (NodeId id = 0; id < changes.tree()->nodes().size(); ++id) {
            if (changes.tree()->node(id).points == 0) continue;
            const Chunk chunk = changes.read(id, ColumnSet::all(changes.tree()->info().schema));
            EXPECT_EQ(chunk.sizes, nullptr);
            changes.write(id, chunk, {});
        }
        changes.commit();
        EXPECT_EQ(codes_of(now()), std::set<int>{unknown_size});
    }

    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct";
    Sizes sizes_;
};

TEST_F(SizesOfTree, AreDistancesOfNeighbours)
{
    // 20000 points on 100 x 100 units: a grid of that density has neighbours 0.7 apart.
    const double least = least_point_size(Tree::open(path_)->info().grid);
    std::vector<double> sizes;
    for (const auto& entry : sizes_) {
        EXPECT_NE(entry.second, unknown_size);
        sizes.push_back(point_size(entry.second, least));
    }
    std::sort(sizes.begin(), sizes.end());
    EXPECT_GT(sizes[sizes.size() / 2], 0.7);
    EXPECT_LT(sizes[sizes.size() / 2], 1.2);
    EXPECT_GT(codes_of(sizes_).size(), 5u);
}

TEST_F(SizesOfTree, DoNotDependOnTheThreads)
{
    MemoryCloud cloud = surface(20000, 0, 0, 100, 17);
    for (const unsigned threads : {1u, 3u}) {
        MemoryReader reader(cloud);
        BuildOptions options = small_build();
        options.threads = threads;
        options.overwrite = true;
        build_tree(reader, {"first.las"}, folder_ / "other.pct", options);
        EXPECT_EQ(sizes_of(*Tree::open(folder_ / "other.pct")), sizes_);
    }
}

TEST_F(SizesOfTree, OfPointsThatStayAfterADeletion)
{
    erase("classification=3");
    const Sizes rest = now();
    EXPECT_LT(rest.size(), 19000u);
    EXPECT_EQ(expect_kept(sizes_, rest), rest.size());
    // A deletion that leaves whole chunks as they are, or makes leaves of nodes.
    erase("x<1060");
    EXPECT_EQ(expect_kept(sizes_, now()), now().size());
}

// A node that loses all nodes below it is written again, though it loses no point itself.
TEST_F(SizesOfTree, OfANodeThatBecomesALeaf)
{
    {
        const auto cloud = PointCloud::open(path_, {}, Access::write);
        const std::shared_ptr<const Tree> tree = cloud->tree();
        const NodeTable& nodes = tree->nodes();
        std::size_t parent = nodes.size();
        do --parent;
        while (nodes[parent].points == 0 || nodes[parent].is_leaf());
        const auto is_below = [&](NodeId id) {
            while (id > parent) id = nodes[id].parent;  // parents come first
            return id == parent;
        };
        Query query;
        query.attributes = {"classification"};
        auto cursor = cloud->edit(query);
        for (EditView view; cursor.getNextData(view);) {
            if (view.node() == parent || nodes[view.node()].parent == no_node || !is_below(view.node())) continue;
            for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, 99);
            view.mark_written();
        }
        cloud->close();
    }
    erase("classification=99");
    const Sizes rest = now();
    EXPECT_EQ(expect_kept(sizes_, rest), rest.size());
}

TEST_F(SizesOfTree, StayWhenAttributesAreSet)
{
    for (const char* which : {"one", "all", "new"}) {
        SCOPED_TRACE(which);
        const bool new_attribute = which == std::string("new");
        L2Options cache;
        cache.capacity_bytes = 1 << 20;  // chunks are written back on the way
        const auto cloud = PointCloud::open(path_, cache, Access::write);
        if (new_attribute) cloud->add_attribute({"mark", ScalarType::u8});
        Query query;
        query.attributes = {new_attribute ? "mark" : "classification"};
        if (which == std::string("all")) query.attributes = {"classification", "intensity", "rgb", "gps_time"};
        std::size_t points = 0;
        auto cursor = cloud->edit(query);
        for (EditView view; cursor.getNextData(view); view.mark_written(), points += view.size())
            for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, 77);
        EXPECT_EQ(points, 20000u);
        cloud->close();
        EXPECT_EQ(now(), sizes_);
    }
}

TEST_F(SizesOfTree, OfBothPartsAfterAnAddition)
{
    const auto first = Tree::open(path_);
    append(18);
    const Sizes both = now();
    EXPECT_EQ(both.size(), 28000u);
    EXPECT_EQ(expect_kept(sizes_, both), 20000u);
    for (const auto& entry : both) EXPECT_NE(entry.second, unknown_size);
    erase("classification=5");
    EXPECT_EQ(expect_kept(both, now()), now().size());
}

TEST_F(SizesOfTree, AfterARepairAndInACopy)
{
    append(19);
    const Sizes both = now();
    clone_tree(path_, folder_ / "copy.pct");
    EXPECT_EQ(sizes_of(*Tree::open(folder_ / "copy.pct")), both);
    fs::remove(path_ / index_file_name);
    RepairOptions options;
    options.threads = 2;
    EXPECT_TRUE(repair_tree(path_, options).index_written);
    EXPECT_EQ(now(), both);
}

// A compacted tree is built anew: its sizes take the points of all parts into account.
TEST_F(SizesOfTree, AreFoundAgainByCompacting)
{
    append(20);
    const Sizes both = now();
    CompactOptions options;
    options.memory_bytes = 64 << 20;
    options.chunk_points = 1000;
    options.threads = 2;
    compact_tree(path_, options);
    const Sizes compacted = now();
    ASSERT_EQ(compacted.size(), both.size());
    std::size_t smaller = 0, larger = 0;
    for (const auto& [point, size] : both) {
        EXPECT_NE(compacted.at(point), unknown_size);
        smaller += compacted.at(point) < size;
        larger += compacted.at(point) > size;
    }
    EXPECT_GT(smaller, 1000u);
    EXPECT_LT(5 * larger, smaller);  // the groups of points that bound a size are others in other bins
}

// Trees that were built before sizes were kept.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(SizesOfTree, PCM_NOT_UNDER_THREAD(TreesWithoutThemStayUsable))
{
    const auto before = rows_of(*Tree::open(path_));
    forget_sizes();
    expect_tree(path_, before, "without sizes");
    erase("classification=3");
    EXPECT_EQ(codes_of(now()), std::set<int>{unknown_size});
    append(21);
    std::size_t unknown = 0;
    for (const auto& entry : now()) unknown += entry.second == unknown_size;
    EXPECT_EQ(unknown, now().size() - 8000);
    {
        const auto cloud = PointCloud::open(path_, {}, Access::write);
        Query query;
        query.attributes = {"classification"};
        auto cursor = cloud->edit(query);
        for (EditView view; cursor.getNextData(view); view.mark_written())
            for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, 7);
        cloud->close();
    }
    EXPECT_EQ(now().size() - 8000, unknown);
    CompactOptions options;
    options.memory_bytes = 64 << 20;
    options.threads = 2;
    compact_tree(path_, options);
    EXPECT_EQ(codes_of(now()).count(unknown_size), 0u);
}

}  // namespace
