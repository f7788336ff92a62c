// Opening and verifying trees, whole and damaged ones.

#include "pcm/tree/tree.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/support.h"
#include "pcm/build/builder.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/verify.h"

#include <fstream>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class TreeTest : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 20000, 3), {});
        BuildOptions options;
        options.chunk_points = 2000;
        build_tree({folder_ / "in.las"}, tree(), options);
    }
    fs::path tree() const { return folder_ / "out.pct"; }
    ErrorCode open_fails(const fs::path& path, const std::string& must_name = "")
    {
        try {
            Tree::open(path);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(must_name.empty() ? path.string() : must_name), std::string::npos)
                << error.what();
            return error.code();
        }
        ADD_FAILURE() << "opened " << path;
        return ErrorCode::io;
    }
    static std::string read(const fs::path& path)
    {
        std::ifstream file(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    }
    static void write(const fs::path& path, const std::string& bytes)
    {
        std::ofstream(path, std::ios::binary) << bytes;
    }
    TemporaryFolder folder_;
};

TEST_F(TreeTest, OpensByFolderByIndexAndFromInside)
{
    const auto points = Tree::open(tree())->info().points;
    EXPECT_EQ(points, 20000u);
    EXPECT_EQ(Tree::open(tree() / index_file_name)->info().points, points);
    EXPECT_EQ(Tree::open(tree() / "")->info().points, points);
    const fs::path before = fs::current_path();
    fs::current_path(tree());
    EXPECT_EQ(Tree::open(index_file_name)->info().points, points);  // as file dialogs do it
    fs::current_path(before);
    EXPECT_TRUE(is_tree(tree()));
    EXPECT_FALSE(is_tree(folder_.path()));
}

TEST_F(TreeTest, WhatIsNoTreeIsSaidToBeNone)
{
    EXPECT_EQ(open_fails(folder_.path(), "index.pct"), ErrorCode::not_a_tree);
    EXPECT_EQ(open_fails(folder_ / "in.las"), ErrorCode::not_a_tree);
    EXPECT_EQ(open_fails(folder_ / "nothing"), ErrorCode::not_found);
    fs::create_directory(folder_ / "odd.pct");
    write(folder_ / "odd.pct" / index_file_name, "PCTREE1 some other program's file, long enough to be one");
    EXPECT_EQ(open_fails(folder_ / "odd.pct"), ErrorCode::not_a_tree);
    write(folder_ / "odd.pct" / index_file_name, "");
    EXPECT_EQ(open_fails(folder_ / "odd.pct"), ErrorCode::not_a_tree);
}

TEST_F(TreeTest, NodesAreWalkable)
{
    const auto tree = Tree::open(this->tree());
    for (NodeId id = 0; id < tree->nodes().size(); ++id) {
        const auto path = tree->path_from_root(id);
        EXPECT_EQ(path.front(), 0u);
        EXPECT_EQ(path.back(), id);
        EXPECT_EQ(path.size(), tree->node(id).depth + 1u);
        EXPECT_TRUE(tree->box(0).contains(tree->box(id)));
    }
}

TEST_F(TreeTest, ATruncatedDataFileIsRefused)
{
    fs::resize_file(tree() / "chunks-000.bpc", fs::file_size(tree() / "chunks-000.bpc") - 1);
    EXPECT_EQ(open_fails(tree(), "chunks-000.bpc"), ErrorCode::truncated);
    fs::remove(tree() / "chunks-000.bpc");
    EXPECT_EQ(open_fails(tree(), "chunks-000.bpc"), ErrorCode::not_found);
}

TEST_F(TreeTest, ATruncatedIndexIsRefusedAtEveryLength)
{
    const std::string index = read(tree() / index_file_name);
    for (std::size_t length = 0; length < index.size(); length += 1 + length / 50) {
        write(tree() / index_file_name, index.substr(0, length));
        EXPECT_THROW(Tree::open(tree()), Error) << length;
    }
    write(tree() / index_file_name, index + "x");
    EXPECT_THROW(Tree::open(tree()), Error);
}

// Whatever byte of whatever file changes, verify notices.
TEST_F(TreeTest, VerifyNoticesAnyDamage)
{
    EXPECT_TRUE(verify_tree(tree()).faults.empty());
    std::mt19937_64 random(5);
    for (const char* name : {index_file_name, "chunks-000.bpc"}) {
        const std::string good = read(tree() / name);
        for (int round = 0; round < 150; ++round) {
            std::string bad = good;
            bad[random() % bad.size()] ^= static_cast<char>(1 + random() % 255);
            write(tree() / name, bad);
            bool noticed = false;
            try {
                const VerifyReport report = verify_tree(tree());
                noticed = !report.faults.empty();
                if (noticed) EXPECT_NE(report.faults[0].find(name), std::string::npos) << report.faults[0];
            } catch (const Error&) {
                noticed = true;
            }
            EXPECT_TRUE(noticed);
        }
        write(tree() / name, good);
    }
}

// The layout of an index in FORMAT.md: its last eight bytes are the checksum of all others. A change is a new version.
TEST(TreeIndex, FrozenBytes)
{
    TreeIndex index;
    TreeInfo& info = index.info;
    info.points = 7;
    info.points_skipped = 2;
    info.content_hash = 0x0123456789abcdef;
    info.position_error = 0.25;
    info.grid = {{0.001, 0.001, 0.01}, {500000, 4800000, 100}};
    info.position_type = ScalarType::i32;
    info.sampling = Sampling::poisson;
    info.spacings = {1.5, 0.75, 0};
    info.levels = 3;
    info.box = {{-5, -6, -7}, {50, 60, 70}};
    info.extremes = {Vec3i{-5, 0, 0}, {50, 0, 0}, {0, -6, 0}, {0, 60, 0}, {0, 0, -7}, {0, 0, 70}};
    info.schema.add({"intensity", ScalarType::u16, 1, 1.0, 0.0, "raw"});
    info.schema.add({"rgb", ScalarType::u8, 3, 1.0, 0.0, {}});
    info.metadata = {{"key", {std::byte{1}, std::byte{2}}}};
    info.sources = {"a.las"};
    index.data_files = {{1000, 1}};
    Node root, leaf;
    root.children = {1, no_node};
    root.points = 4;
    root.level_points = {3, 1};
    root.subtree_points = 7;
    root.box = info.box;
    root.spacing = 0.75;
    root.extent = {0, 0, 400, 200};
    leaf.parent = 0;
    leaf.depth = 1;
    leaf.first_level = 2;
    leaf.points = 3;
    leaf.level_points = {3};
    leaf.subtree_points = 3;
    leaf.box = {{0, 0, 0}, {50, 60, 70}};
    leaf.extent = {0, 400, 500, 210};
    index.nodes = {root, leaf};
    const std::vector<std::byte> bytes = encode_index(index);
    std::uint64_t sum = 0;
    std::memcpy(&sum, bytes.data() + bytes.size() - 8, 8);
    EXPECT_EQ(bytes.size(), 703u);
    EXPECT_EQ(sum, 5211536014118567881u);
    const TreeIndex again = decode_index(bytes, "index");
    EXPECT_EQ(again.info.spacings, info.spacings);
    EXPECT_EQ(again.nodes[0].level_points, root.level_points);
    EXPECT_EQ(again.nodes[1].first_level, 2);
    EXPECT_EQ(encode_index(again), bytes);
}

// An index whose checksum holds but whose nodes make no sense: written by a program gone wrong.
TEST_F(TreeTest, AnIndexThatMakesNoSenseIsRefused)
{
    const std::string good = read(tree() / index_file_name);
    std::vector<std::byte> bytes(good.size());
    std::memcpy(bytes.data(), good.data(), good.size());
    const TreeIndex index = decode_index(bytes, "index");
    ASSERT_GT(index.nodes.size(), 5u);
    EXPECT_EQ(encode_index(index), bytes);
    const auto refused = [&](const std::function<void(TreeIndex&)>& change, const std::string& why) {
        TreeIndex changed = index;
        change(changed);
        try {
            decode_index(encode_index(changed), "index");
            ADD_FAILURE() << "not refused: " << why;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
        }
    };
    refused([](TreeIndex& i) { i.nodes[2].parent = 3; }, "false child");
    refused([](TreeIndex& i) { i.nodes[2].parent = no_node; }, "false child");
    refused([](TreeIndex& i) { i.nodes[1].children[0] = 1; }, "false child");
    refused([](TreeIndex& i) { i.nodes[1].depth = 7; }, "one step below");
    refused([](TreeIndex& i) { ++i.nodes[1].points; }, "as many points");
    refused([](TreeIndex& i) { ++i.nodes[1].level_points.back(); }, "of which levels");
    refused([](TreeIndex& i) { i.nodes[1].first_level = i.info.levels; }, "points of no level");
    refused([](TreeIndex& i) { std::swap(i.info.spacings[0], i.info.spacings[1]); }, "spacing out of order");
    refused([](TreeIndex& i) { i.info.spacings[0] = std::nan(""); }, "spacing out of order");
    refused([](TreeIndex& i) { --i.nodes[1].box.min[0], i.nodes[1].box.min[0] -= 1000000; }, "out of its parent's box");
    refused([](TreeIndex& i) { i.nodes[1].extent.offset = i.data_files[0].bytes; }, "outside the data files");
    refused([](TreeIndex& i) { i.nodes[1].extent.file = 9; }, "outside the data files");
    refused([](TreeIndex& i) { i.nodes[1].spacing = std::nan(""); }, "no spacing");
    refused([](TreeIndex& i) { i.info.points += 1; }, "root does not hold");
    refused([](TreeIndex& i) { i.nodes.clear(); }, "points without nodes");
    refused([](TreeIndex& i) { i.info.spacings.pop_back(), --i.info.levels; }, "points of no level");
    refused([](TreeIndex& i) { i.info.spacings.assign(257, 1), i.info.levels = 257; }, "number of levels");
}

// Chunks swapped in the index: each is whole, but none is where it should be.
TEST_F(TreeTest, VerifyNoticesSwappedChunks)
{
    const std::string good = read(tree() / index_file_name);
    std::vector<std::byte> bytes(good.size());
    std::memcpy(bytes.data(), good.data(), good.size());
    TreeIndex index = decode_index(bytes, "index");
    std::swap(index.nodes[1].extent, index.nodes[2].extent);
    bytes = encode_index(index);
    write(tree() / index_file_name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    EXPECT_FALSE(verify_tree(tree()).faults.empty());
}

TEST_F(TreeTest, OpenLeavesNoFileDescriptorBehindAndTreesAreShared)
{
    for (int i = 0; i < 2000; ++i) Tree::open(tree());  // more than a process may have open at once
}

}  // namespace
