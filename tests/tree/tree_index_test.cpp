#include "pcm/tree/tree_index.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "tests/tree/index_of_version_3.h"
#include "tests/tree/small_tree.h"

#include <cmath>
#include <cstring>
#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

using TreeIndexTest = SmallTree;

// A root and a leaf, and something in every field.
TreeIndex small_index()
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
    return index;
}

void expect_small_index(const TreeIndex& again)
{
    const TreeIndex index = small_index();
    EXPECT_TRUE(same_info(again.info, index.info));
    ASSERT_EQ(again.nodes.size(), 2u);
    EXPECT_EQ(again.nodes[0].level_points, index.nodes[0].level_points);
    EXPECT_EQ(again.nodes[1].first_level, 2);
    EXPECT_EQ(again.nodes[1].part, 0u);
    EXPECT_EQ(again.part_roots, index.part_roots);
    EXPECT_EQ(again.data_files, index.data_files);
}

// The layout of an index in FORMAT.md. A change is a new version.
TEST(TreeIndex, FrozenBytes)
{
    const std::vector<std::byte> bytes = encode_index(small_index());
    EXPECT_EQ(bytes.size(), 791u);
    EXPECT_EQ(checksum(bytes.data(), bytes.size()), 11347409779878390813u);
    const TreeIndex again = decode_index(bytes, "index");
    expect_small_index(again);
    EXPECT_EQ(encode_index(again), bytes);
    // A page a node: one more entry of 20 bytes in the head.
    TreeIndex pages = small_index();
    pages.pages = {1, 1};
    const std::vector<std::byte> in_pages = encode_index(pages);
    EXPECT_EQ(in_pages.size(), 811u);
    EXPECT_EQ(encode_index(decode_index(in_pages, "index")), in_pages);
}

TEST(TreeIndex, AnIndexOfVersion3IsRead)
{
    const std::vector<std::byte> bytes = index_of_version_3(small_index());
    std::uint64_t sum = 0;
    std::memcpy(&sum, bytes.data() + bytes.size() - 8, 8);
    EXPECT_EQ(bytes.size(), 703u);
    EXPECT_EQ(sum, 5211536014118567881u);  // what programs wrote that had this version
    expect_small_index(decode_index(bytes, "index"));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::vector<std::byte> changed = bytes;
        changed[at] ^= std::byte{1};
        EXPECT_THROW(decode_index(changed, "index"), Error) << at;
        changed = bytes;
        changed.resize(at);
        EXPECT_THROW(decode_index(changed, "index"), Error) << at;
    }
}

TEST(TreeIndex, ADamagedVersionIsToldFromAnother)
{
    for (std::vector<std::byte> bytes : {encode_index(small_index()), index_of_version_3(small_index())}) {
        bytes[8] = std::byte{9};
        try {
            decode_index(bytes, "index");
            ADD_FAILURE() << "not refused";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::corrupt) << error.what();
        }
        bytes[40] ^= std::byte{1};
        try {
            decode_index(bytes, "index");
            ADD_FAILURE() << "not refused";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::unsupported) << error.what();
        }
    }
}

// In both versions, with the nodes in one page and in pages of one and of two.
void expect_refused(TreeIndex index, const std::string& why)
{
    std::vector<std::vector<std::byte>> all{index_of_version_3(index)};
    for (const std::uint32_t nodes : {1u, 2u, 1000u}) {
        index.pages = pages_of(nodes, index.nodes.size());
        all.push_back(encode_index(index));
    }
    for (const std::vector<std::byte>& bytes : all) try {
            decode_index(bytes, "index");
            ADD_FAILURE() << "not refused: " << why;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
        }
}

// Indexes with a matching checksum and invalid nodes, as a faulty program would write them.
TEST_F(TreeIndexTest, AnInvalidIndexIsRefused)
{
    build();
    const TreeIndex index = this->index();
    ASSERT_GT(index.nodes.size(), 5u);
    EXPECT_EQ(encode_index(index), read_file(index_path()));
    const auto refused = [&](const std::function<void(TreeIndex&)>& change, const std::string& why) {
        TreeIndex changed = index;
        change(changed);
        expect_refused(changed, why);
    };
    refused([](TreeIndex& i) { i.nodes[2].parent = 3; }, "comes before its parent");
    refused([](TreeIndex& i) { i.nodes[2].parent = no_node; }, "no place under the root");
    refused([](TreeIndex& i) { i.nodes[3].parent = 0; }, "is not its parent's child");
    refused([](TreeIndex& i) { i.nodes[1].children[0] = i.nodes[2].children[0]; }, "not its parent's child");
    refused([](TreeIndex& i) { i.nodes[1].children[0] = 1; }, "false child");
    refused([](TreeIndex& i) { i.nodes[1].depth = 7; }, "one step below");
    refused([](TreeIndex& i) { ++i.nodes[1].points, ++i.nodes[1].level_points.back(); }, "as many points");
    refused([](TreeIndex& i) { ++i.nodes[1].points; }, "of which levels");
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

// A chunk's header has room for paths of 128 steps.
TEST(TreeIndex, APartThatIsTooDeepIsRefused)
{
    for (std::size_t depth = NodePath::max_depth; depth <= NodePath::max_depth + 1u; ++depth) {
        TreeIndex index;
        index.info.points = 1;
        index.info.spacings = {0};
        index.info.levels = 1;
        index.info.box = {{0, 0, 0}, {9, 9, 9}};
        index.data_files = {{100, 1}};
        index.nodes.resize(depth + 1);
        for (NodeId id = 0; id <= depth; ++id) {
            Node& node = index.nodes[id];
            node.parent = id == 0 ? no_node : id - 1;
            if (id < depth) node.children[id % 2] = id + 1;
            node.depth = static_cast<std::uint16_t>(id);
            node.subtree_points = 1;
            node.box = index.info.box;
        }
        index.nodes.back().points = 1;
        index.nodes.back().level_points = {1};
        index.nodes.back().extent = {0, 0, 40, 10};
        if (depth > NodePath::max_depth)
            expect_refused(index, "is too deep in its part");
        else
            EXPECT_EQ(decode_index(encode_index(index), "index").nodes.size(), depth + 1);
    }
}

// A node without points over two parts, one of which has two nodes; a third part has lost all its points.
TreeIndex two_parts()
{
    TreeIndex index;
    index.info.generation = 2;
    index.info.points = 9;
    index.info.spacings = {1, 0};
    index.info.levels = 2;
    index.info.box = {{0, 0, 0}, {9, 9, 9}};
    index.data_files = {{100, 1}, {50, 2}};
    index.nodes.resize(4);
    const auto set = [&](NodeId id, NodeId parent, std::uint16_t depth, std::uint32_t points, std::uint64_t below,
                         Extent extent) {
        Node& node = index.nodes[id];
        node.parent = parent;
        node.depth = depth;
        node.points = points;
        if (points) node.level_points = {points};
        node.subtree_points = below;
        node.box = index.info.box;
        node.extent = extent;
    };
    set(0, no_node, 0, 0, 9, {});
    set(1, 0, 1, 2, 5, {0, 0, 40, 10});
    set(2, 0, 1, 4, 4, {1, 0, 30, 10});
    set(3, 1, 2, 3, 3, {0, 40, 30, 10});
    index.nodes[0].children = {1, 2};
    index.nodes[1].children = {no_node, 3};
    index.part_roots = {1, no_node, 2};
    return index;
}

TEST(TreeParts, ComeBackAndAreChecked)
{
    const auto bytes = encode_index(two_parts());
    const TreeIndex back = decode_index(bytes, "index");
    EXPECT_EQ(encode_index(back), bytes);
    EXPECT_EQ(back.part_roots, two_parts().part_roots);
    EXPECT_EQ(back.nodes[0].part, no_part);
    EXPECT_EQ(back.nodes[1].part, 0u);
    EXPECT_EQ(back.nodes[2].part, 2u);
    EXPECT_EQ(back.nodes[3].part, 0u);
    const auto refused = [&](const std::function<void(TreeIndex&)>& change, const std::string& why) {
        TreeIndex changed = two_parts();
        change(changed);
        expect_refused(changed, why);
    };
    refused([](TreeIndex& i) { i.part_roots = {1, 1, 2}; }, "root of two parts");
    refused([](TreeIndex& i) { i.part_roots = {1, 3, 2}; }, "inside another part");
    refused([](TreeIndex& i) { i.part_roots = {1, 4, 2}; }, "does not exist");
    refused([](TreeIndex& i) { i.part_roots = {1}; }, "belongs to no part");
    refused([](TreeIndex& i) { i.part_roots = {3, 2}; }, "belongs to no part");
    refused([](TreeIndex& i) { i.part_roots = {}; }, "parts without nodes");
    refused([](TreeIndex& i) { i.data_files[1].generation = 3; }, "of generation 3");
    refused([](TreeIndex& i) { i.data_files[1].generation = 0; }, "of generation 0");
    refused([](TreeIndex& i) { i.info.generation = 1; }, "of generation 2");
    refused([](TreeIndex& i) { i.data_files[1].bytes = 0; }, "outside the data files");
    refused([](TreeIndex& i) { i.nodes[1].extent.header_bytes = 41; }, "outside the data files");
}

}  // namespace
