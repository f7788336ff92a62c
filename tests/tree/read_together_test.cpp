// Which chunks are read at once, and what that saves: counts of reads, and every chunk the same as when read alone.

#include "pcm/tree/read_together.h"

#include "pcm/bpc/chunk_bytes.h"
#include "pcm/bpc/chunk_header.h"
#include "pcm/cache/l2_cache.h"
#include "pcm/system/work_done.h"
#include "pcm/tree/column_shares.h"
#include "pcm/view/level_of_detail.h"
#include "tests/tree/small_tree.h"
#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

using Numbers = std::vector<std::size_t>;

Extent place(std::uint32_t file, std::uint64_t offset, std::uint64_t bytes) { return {file, offset, bytes, 100}; }

TEST(ReadTogether, TakesNeighboursOfTheFirstOneOnBothSides)
{
    EXPECT_EQ(read_together({place(0, 1000, 500)}), Numbers({0}));
    EXPECT_EQ(read_together({place(0, 1000, 500), place(0, 1500, 10), place(0, 400, 600)}), Numbers({2, 0, 1}));
    EXPECT_EQ(read_together({place(0, 1000, 500), place(1, 1500, 10)}), Numbers({0})) << "another file";
    EXPECT_EQ(read_together({place(0, 0, 0), place(0, 0, 10)}), Numbers({0})) << "a node without points";
}

TEST(ReadTogether, StopsAtGapsThatAreBetterSkipped)
{
    const std::uint64_t end = 1500;
    EXPECT_EQ(read_together({place(0, 1000, 500), place(0, end + join_gap, 10)}), Numbers({0, 1}));
    EXPECT_EQ(read_together({place(0, 1000, 500), place(0, end + join_gap + 1, 10)}), Numbers({0}));
    const std::uint64_t far = 10 * join_gap;
    EXPECT_EQ(read_together({place(0, far, 500), place(0, far - join_gap - 10, 10)}), Numbers({1, 0}));
    EXPECT_EQ(read_together({place(0, far, 500), place(0, far - join_gap - 11, 10)}), Numbers({0}));
}

TEST(ReadTogether, StopsWhenThereIsEnough)
{
    const std::uint64_t third = most_read_together / 3;
    EXPECT_EQ(read_together(
                  {place(0, 0, third), place(0, third, third), place(0, 2 * third, third), place(0, 3 * third, third)}),
              Numbers({0, 1, 2}));
    EXPECT_EQ(read_together(
                  {place(0, 3 * third, third), place(0, 2 * third, third), place(0, third, third), place(0, 0, third)}),
              Numbers({2, 1, 0}));
    EXPECT_EQ(read_together({place(0, 0, 2 * most_read_together), place(0, 2 * most_read_together, 1)}), Numbers({0}))
        << "a chunk beyond the limit is read alone";
}

// A damaged index may say that chunks overlap, or name one twice.
TEST(ReadTogether, LeavesOverlappingChunksAlone)
{
    EXPECT_EQ(read_together({place(0, 1000, 500), place(0, 1000, 500)}).size(), 1u);
    EXPECT_EQ(read_together({place(0, 1000, 500), place(0, 1499, 500)}), Numbers({0}));
    EXPECT_EQ(read_together({place(0, 1000, 500), place(0, 600, 401)}), Numbers({0}));
}

BpcHeader header_of(std::uint64_t positions, std::uint64_t attribute, std::uint64_t sizes)
{
    BpcHeader header;
    header.header_bytes = 1000;
    header.positions.offset = 1000;
    header.positions.bytes = positions;
    header.attributes.resize(1);
    header.attributes[0].offset = 1000 + positions;
    header.attributes[0].bytes = attribute;
    header.sizes.emplace();
    header.sizes->offset = 1000 + positions + attribute;
    header.sizes->bytes = sizes;
    header.total_bytes = 1000 + positions + attribute + sizes;
    return header;
}

TEST(ColumnShares, AFirstReadHasTheWantedColumns)
{
    ColumnShares shares;
    const Extent extent{0, 0, 101000, 1000};
    const ColumnSet positions = ColumnSet::only_positions();
    ColumnSet positions_and_sizes = positions, attribute;
    positions_and_sizes.sizes = true;
    attribute.positions = false;
    attribute.attributes.set(0);
    EXPECT_EQ(shares.at_first(extent, positions), 101000u) << "nothing is known yet: everything";
    EXPECT_EQ(shares.at_first({0, 0, std::uint64_t{1} << 30, 1000}, positions), ColumnShares::most_at_first);
    EXPECT_TRUE(shares.are_most(attribute));

    shares.learn(header_of(50000, 40000, 10000));
    EXPECT_GE(shares.at_first(extent, positions), 51000u);
    EXPECT_LE(shares.at_first(extent, positions), 60000u);
    EXPECT_EQ(shares.at_first(extent, positions_and_sizes), 101000u);
    EXPECT_EQ(shares.at_first(extent, attribute), 1000u) << "less than half of what lies before its end";
    EXPECT_TRUE(shares.are_most(positions_and_sizes));
    EXPECT_FALSE(shares.are_most(attribute));
    // Columns change their share from chunk to chunk, and what is read follows.
    for (int i = 0; i < 100; ++i) shares.learn(header_of(20000, 10000, 70000));
    EXPECT_LE(shares.at_first(extent, positions), 30000u);
    EXPECT_EQ(shares.at_first(extent, positions_and_sizes), 101000u);
    EXPECT_FALSE(shares.are_most(positions));
}

class ReadsOfATree : public testing::Test {
protected:
    void build(std::size_t points, std::uint32_t chunk_points)
    {
        write_las(folder_ / "in.las", records(Shape::surface, points, 3), {});
        BuildOptions options;
        options.chunk_points = chunk_points;
        options.threads = 2;
        build_tree({folder_ / "in.las"}, folder_ / "out.pct", options);
        tree_ = Tree::open(folder_ / "out.pct");
    }
    ColumnSet colours() const
    {
        ColumnSet columns = ColumnSet::only_positions();
        columns.sizes = true;
        columns.attributes.set(*tree_->info().schema.find("rgb"));
        return columns;
    }
    static void expect_same(const Chunk& a, const Chunk& b)
    {
        ASSERT_EQ(a.points, b.points);
        ASSERT_TRUE(a.columns() == b.columns());
        for (std::size_t i = 0; a.positions && i < a.points; ++i) ASSERT_EQ(a.positions->grid(i), b.positions->grid(i));
        for (std::size_t k = 0; k < a.attributes.size(); ++k)
            if (a.attributes[k]) {
                ASSERT_EQ(std::memcmp(a.attributes[k]->data(), b.attributes[k]->data(), a.attributes[k]->bytes()), 0);
            }
        if (a.sizes) {
            ASSERT_EQ(std::memcmp(a.sizes->data(), b.sizes->data(), a.sizes->bytes()), 0);
        }
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

TEST_F(ReadsOfATree, ManyChunksAreTheSameAsEachAlone)
{
    build(60000, 1000);
    const std::size_t count = tree_->nodes().size();
    std::mt19937 random(7);
    for (const bool few : {true, false}) {
        std::vector<ChunkRequest> requests;
        ColumnSet flags;
        flags.attributes.set(*tree_->info().schema.find("classification"));
        for (std::size_t i = 0; i < 3 * count / 2; ++i)  // some nodes twice
            requests.push_back({static_cast<NodeId>(random() % count), few && random() % 2 ? flags : colours()});
        std::vector<int> taken(requests.size(), 0);
        tree_->read_chunks(requests, [&](std::size_t i, Chunk chunk, const std::exception_ptr& failure) {
            EXPECT_FALSE(failure);
            ++taken[i];
            expect_same(chunk, tree_->read_chunk(requests[i].node, requests[i].columns));
        });
        EXPECT_EQ(taken, std::vector<int>(requests.size(), 1));
    }
}

// A view of a part of the points: index page and chunks in ranges of a MiB, whatever the number of chunks.
TEST_F(ReadsOfATree, TheFirstViewIsAFewRanges)
{
    build(600000, 2000);
    const WorkDone before_opening = work_done();
    const std::shared_ptr<const Tree> tree = Tree::open(folder_ / "out.pct");
    EXPECT_LE((work_done() - before_opening).reads, 3u);

    const Box3d box = tree->info().bounds();
    const Vec3d half = 0.5 * (box.max - box.min);
    Camera view;
    view.modelview = identity();
    view.projection = orthographic(half[0], half[1], -2 * half[2] - 1, 2 * half[2] + 1);
    view.origin = box.centre();
    view.width = view.height = 1000;
    DetailLimits limits;
    limits.point_budget = 300000;
    limits.target_px = 1e-6;
    std::vector<ChunkRequest> requests;
    std::uint64_t bytes = 0, points = 0;
    for (const DetailNode& node : select_detail(*tree, view, limits).wanted) {
        requests.push_back({node.node, colours()});
        bytes += tree->node(node.node).extent.bytes;
        points += tree->node(node.node).points;
    }
    ASSERT_GT(points, 250000u);
    ASSERT_GT(requests.size(), 100u);
    const WorkDone before = work_done();
    L2Cache cache(tree);
    std::atomic<std::size_t> loaded{0};
    cache.request(requests, [&](NodeId) { ++loaded; });
    cache.wait_idle();
    EXPECT_EQ(loaded, requests.size());
    EXPECT_EQ(cache.statistics().failed_loads, 0u);
    EXPECT_LE((work_done() - before).reads, 2 * bytes / most_read_together + 6);
}

TEST_F(ReadsOfATree, HeaderAndColumnsAreOneRead)
{
    build(60000, 1000);
    tree_->read_chunk(0, ColumnSet::only_positions());
    const WorkDone before = work_done();
    for (NodeId id = 0; id < tree_->nodes().size(); ++id) tree_->read_chunk(id, ColumnSet::only_positions());
    EXPECT_LE((work_done() - before).reads, tree_->nodes().size() * 11 / 10);
}

// Columns that are a small part of their chunks are read by themselves.
TEST_F(ReadsOfATree, AFewColumnsCostTheirOwnBytes)
{
    build(60000, 10000);
    ColumnSet intensity;
    intensity.positions = false;
    intensity.attributes.set(*tree_->info().schema.find("intensity"));
    std::vector<ChunkRequest> requests;
    std::uint64_t all = 0, own = 0;
    for (NodeId id = 0; id < tree_->nodes().size(); ++id) {
        requests.push_back({id, intensity});
        all += tree_->node(id).extent.bytes;
        own += tree_->node(id).points * 2;
    }
    tree_->read_chunk(0, intensity);  // what a chunk looks like is known from here on
    const WorkDone before = work_done();
    tree_->read_chunks(requests, [](std::size_t, Chunk, const std::exception_ptr& failure) { EXPECT_FALSE(failure); });
    ASSERT_LT(own + join_gap * requests.size(), all);
    EXPECT_LT((work_done() - before).bytes_read, all / 2);
}

// Its checksums match, and it is in another node's place.
TEST_F(ReadsOfATree, AChunkOfAnotherNodeIsRefused)
{
    build(60000, 1000);
    const auto path = folder_ / "out.pct" / "index.pct";
    TreeIndex index = decode_index(read_file(path), path);
    std::vector<NodeId> with_points;
    for (NodeId id = 0; id < index.nodes.size(); ++id)
        if (index.nodes[id].points) with_points.push_back(id);
    const NodeId a = with_points[with_points.size() - 2], b = with_points.back();
    std::swap(index.nodes[a].extent, index.nodes[b].extent);
    const auto tree = Tree::of_index(folder_ / "out.pct", std::move(index));
    std::vector<ChunkRequest> requests;
    for (const NodeId id : with_points) requests.push_back({id, colours()});
    std::set<NodeId> refused;
    tree->read_chunks(requests, [&](std::size_t i, Chunk, const std::exception_ptr& failure) {
        if (!failure) return;
        refused.insert(requests[i].node);
        try {
            std::rethrow_exception(failure);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("does not belong to node"), std::string::npos) << error.what();
        }
    });
    EXPECT_EQ(refused, (std::set<NodeId>{a, b}));
    EXPECT_THROW(tree->read_chunk(a, colours()), Error);
    EXPECT_THROW(tree->read_chunk_part(a, colours(), [](const Box3i&, std::uint16_t) { return true; }), Error);
}

TEST_F(ReadsOfATree, ADamagedChunkFailsAlone)
{
    build(60000, 1000);
    const NodeId victim = static_cast<NodeId>(tree_->nodes().size() / 2);
    const Extent extent = tree_->node(victim).extent;
    ASSERT_GT(extent.bytes, 0u);
    std::vector<std::byte> bytes = read_file(folder_ / "out.pct" / "chunks-000.bpc");
    bytes[extent.offset + extent.header_bytes + 5] ^= std::byte{1};
    tree_.reset();
    write_file(folder_ / "out.pct" / "chunks-000.bpc", bytes);
    tree_ = Tree::open(folder_ / "out.pct");
    std::vector<ChunkRequest> requests;
    for (NodeId id = 0; id < tree_->nodes().size(); ++id) requests.push_back({id, colours()});
    std::vector<NodeId> failed;
    tree_->read_chunks(requests, [&](std::size_t i, Chunk chunk, const std::exception_ptr& failure) {
        if (!failure) {
            EXPECT_EQ(chunk.points, tree_->node(requests[i].node).points);
            return;
        }
        failed.push_back(requests[i].node);
        try {
            std::rethrow_exception(failure);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::corrupt);
            EXPECT_NE(std::string(error.what()).find("chunk at byte " + std::to_string(extent.offset)),
                      std::string::npos);
            EXPECT_NE(std::string(error.what()).find("chunks-000.bpc"), std::string::npos);
        }
    });
    EXPECT_EQ(failed, std::vector<NodeId>({victim}));

    L2Cache cache(tree_);
    std::atomic<std::size_t> called{0};
    cache.request(requests, [&](NodeId) { ++called; });
    cache.wait_idle();
    EXPECT_EQ(called, requests.size());
    EXPECT_EQ(cache.statistics().failed_loads, 1u);
    EXPECT_TRUE(cache.error_of(victim));
}

}  // namespace
