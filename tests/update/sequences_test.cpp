// Updates in any order, against a plain list of rows.

#include "pcm/update/append.h"
#include "pcm/update/compact.h"
#include "pcm/update/erase.h"
#include "pcm/update/repair.h"
#include "tests/sanitizers.h"
#include "tests/update/model.h"

#include <atomic>
#include <fstream>
#include <random>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

std::string bytes_of_file(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

class Sequence {
public:
    Sequence(std::uint64_t seed, Sampling sampling) : random_(seed)
    {
        const MemoryCloud cloud = next_cloud();
        build(cloud, path_, sampling);
        grid_ = Tree::open(path_)->info().grid;
        add(rows_, rows_of(cloud, grid_));
    }

    void run(int steps)
    {
        for (int step = 0; step < steps; ++step) {
            std::string what;
            switch (random_() % 8) {
                case 0:
                case 1:
                case 2:
                    what = append();
                    break;
                case 3:
                case 4:
                case 5:
                    what = erase();
                    break;
                case 6:
                    what = compact();
                    break;
                default:
                    what = lose_the_index();
                    break;
            }
            expect_tree(path_, rows_, "step " + std::to_string(step) + ": " + what);
            if (testing::Test::HasFailure()) return;
        }
    }

private:
    double any(double low, double high) { return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53; }

    MemoryCloud next_cloud()
    {
        return surface(1 + random_() % 9000, any(-50, 50), any(-50, 50), any(1, 80), random_());
    }

    std::string append()
    {
        const MemoryCloud cloud = next_cloud();
        MemoryReader reader(cloud);
        AppendOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        options.threads = 2;
        append_points(path_, reader, {"more.las"}, options);
        add(rows_, rows_of(cloud, grid_));
        return "append " + std::to_string(cloud.points.size);
    }

    std::string erase()
    {
        Selection selection;
        const int kind = static_cast<int>(random_() % 10);
        const double x = 1000 + any(-60, 100), y = 2000 + any(-60, 100), width = kind == 0 ? 1000 : any(1, 60);
        const bool by_class = kind % 3 == 1;
        const auto wanted = static_cast<unsigned char>(random_() % 8);
        selection.box = Box3d{{x - width, y - width, -1000}, {x + width, y + width, 1000}};
        if (by_class) selection.where.push_back(parse_condition("classification=" + std::to_string(wanted)));
        EraseOptions options;
        options.threads = 2;
        const std::uint64_t deleted = erase_points(path_, selection, options).points_deleted;
        const std::size_t before = rows_.size();
        rows_.erase(
            std::remove_if(rows_.begin(), rows_.end(),
                           [&](const Row& row) {
                               return selection.box->contains(grid_.to_source(row.q)) &&
                                      (!by_class || static_cast<unsigned char>(row.attributes.back()) == wanted);
                           }),
            rows_.end());
        EXPECT_EQ(deleted, before - rows_.size());
        return "delete " + std::to_string(deleted);
    }

    std::string compact()
    {
        const TreeInfo before = Tree::open(path_)->info();
        CompactOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        options.threads = 2;
        compact_tree(path_, options);
        const auto tree = Tree::open(path_);
        EXPECT_EQ(tree->info().content_hash, before.content_hash);
        EXPECT_EQ(tree->info().sources, before.sources);
        EXPECT_EQ(tree->info().generation, 1u);
        EXPECT_TRUE(tree->info().coverage_kept);
        return "compact";
    }

    std::string lose_the_index()
    {
        const std::string before = bytes_of_file(path_ / index_file_name);
        fs::remove(path_ / index_file_name);
        RepairOptions options;
        options.threads = 2;
        repair_tree(path_, options);
        EXPECT_TRUE(bytes_of_file(path_ / index_file_name) == before) << "the index is another one";
        return "repair";
    }

    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct";
    std::mt19937_64 random_;
    Grid grid_;
    std::vector<Row> rows_;
};

class Sequences : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Sequences, testing::Range(0, tries(8, 3)));

TEST_P(Sequences, AgainstAPlainList)
{
    Sequence(static_cast<std::uint64_t>(GetParam()), GetParam() % 3 == 2 ? Sampling::grid : Sampling::poisson).run(12);
}

TEST(Compact, MakesTheSameTreeAsABuild)
{
    const TemporaryFolder folder;
    const fs::path path = folder / "tree.pct";
    MemoryCloud cloud = surface(30000, 0, 0, 80, 71);
    cloud.info.metadata.push_back({"las.vlr/a/1", {std::byte{1}, std::byte{2}}});
    build(cloud, path);
    Selection selection;
    selection.where.push_back(parse_condition("classification=3..5"));
    EraseOptions erase;
    erase.threads = 2;
    erase_points(path, selection, erase);
    CompactOptions options;
    options.output = folder / "compact.pct";
    options.memory_bytes = 64 << 20;
    options.chunk_points = 1000;
    options.threads = 2;
    compact_tree(path, options);
    EXPECT_THROW(compact_tree(path, options), std::exception);  // it is there already

    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < cloud.points.size; ++i) {
        const double c = cloud.points.attributes[3].value(i);
        if (c < 3 || c > 5) kept.push_back(i);
    }
    keep_points(cloud.points, kept);
    cloud.info.points = kept.size();
    build(cloud, folder / "fresh.pct");
    for (const auto& entry : fs::directory_iterator(folder / "fresh.pct"))
        EXPECT_TRUE(bytes_of_file(entry.path()) == bytes_of_file(folder / "compact.pct" / entry.path().filename()))
            << entry.path().filename();
}

// Whoever opens a tree while it is updated gets the one before or the one after, whole.
TEST(Compact, ReadersOpenATreeThatIsChangedAllTheTime)
{
    const TemporaryFolder folder;
    const fs::path path = folder / "tree.pct";
    build(surface(3000, 0, 0, 40, 1), path, Sampling::poisson);
    std::atomic<bool> done{false};
    std::thread updates([&] {
        for (std::uint64_t round = 0; round < 25; ++round) {
            const MemoryCloud more = surface(200, 0, 0, 40, 2 + round);
            MemoryReader reader(more);
            append_points(path, reader, {}, {});
            if (round % 3 == 2) compact_tree(path);
        }
        done = true;
    });
    std::uint64_t opened = 0;
    do {
        try {
            const auto tree = Tree::open(path);
            std::uint64_t points = 0;
            for (NodeId id = 0; id < tree->nodes().size(); ++id)
                points += tree->read_chunk(id, ColumnSet::only_positions()).points;
            EXPECT_EQ(points, tree->info().points);
            EXPECT_EQ(points % 200, 0u);
            ++opened;
        } catch (const Error& error) {
            ADD_FAILURE() << error.what();
        }
    } while (!done);
    updates.join();
    EXPECT_EQ(Tree::open(path)->info().points, 8000u);
    EXPECT_GT(opened, 10u);
}

TEST(Compact, KeepsTheGridOfFloats)
{
    const TemporaryFolder folder;
    const fs::path path = folder / "tree.pct";
    build(random_cloud(test_schema(), std::nullopt, 5000, 72), path);
    Selection far;
    far.where.push_back(parse_condition("x>100"));
    EraseOptions erase;
    erase.threads = 2;
    erase_points(path, far, erase);
    const auto before = Tree::open(path);
    CompactOptions options;
    options.memory_bytes = 64 << 20;
    options.threads = 2;
    compact_tree(path, options);
    const auto after = Tree::open(path);
    EXPECT_EQ(after->info().grid, before->info().grid);
    EXPECT_EQ(after->info().content_hash, before->info().content_hash);
    expect_tree(path, rows_of(*before), "compacted");
}

}  // namespace
