// Opening trees and reading their chunks.

#include "pcm/tree/tree.h"

#include "pcm/system/error.h"
#include "tests/tree/small_tree.h"

#include <cstring>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class TreeTest : public SmallTree {
protected:
    static ErrorCode open_fails(const fs::path& path, const std::string& must_name = "")
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
};

TEST_F(TreeTest, OpensByFolderByIndexAndFromInside)
{
    build();
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

TEST_F(TreeTest, OtherFilesAndFoldersAreNoTrees)
{
    build();
    EXPECT_EQ(open_fails(folder_.path(), "index.pct"), ErrorCode::not_a_tree);
    EXPECT_EQ(open_fails(folder_ / "in.las"), ErrorCode::not_a_tree);
    EXPECT_EQ(open_fails(folder_ / "nothing"), ErrorCode::not_found);
    fs::create_directory(folder_ / "odd.pct");
    const std::string strange = "PCTREE1 some other program's file, long enough to be one";
    std::vector<std::byte> bytes(strange.size());
    std::memcpy(bytes.data(), strange.data(), strange.size());
    write_file(folder_ / "odd.pct" / index_file_name, bytes);
    EXPECT_EQ(open_fails(folder_ / "odd.pct"), ErrorCode::not_a_tree);
    write_file(folder_ / "odd.pct" / index_file_name, {});
    EXPECT_EQ(open_fails(folder_ / "odd.pct"), ErrorCode::not_a_tree);
}

TEST_F(TreeTest, NodesAreWalkable)
{
    build();
    const auto tree = Tree::open(this->tree());
    for (NodeId id = 0; id < tree->nodes().size(); ++id) {
        std::size_t depth = 0;
        NodeId above = id;
        for (; tree->node(above).parent != no_node; above = tree->node(above).parent) ++depth;
        EXPECT_EQ(above, 0u);
        EXPECT_EQ(tree->node(id).depth, depth);
        EXPECT_TRUE(tree->box(0).contains(tree->box(id)));
    }
}

TEST_F(TreeTest, ATruncatedDataFileIsRefused)
{
    build();
    fs::resize_file(tree() / "chunks-000.bpc", fs::file_size(tree() / "chunks-000.bpc") - 1);
    EXPECT_EQ(open_fails(tree(), "chunks-000.bpc"), ErrorCode::truncated);
    fs::remove(tree() / "chunks-000.bpc");
    EXPECT_EQ(open_fails(tree(), "chunks-000.bpc"), ErrorCode::not_found);
}

TEST_F(TreeTest, ATruncatedIndexIsRefusedAtEveryLength)
{
    build();
    std::vector<std::byte> index = read_file(index_path());
    for (std::size_t length = 0; length < index.size(); length += 1 + length / 50) {
        write_file(index_path(), {index.begin(), index.begin() + static_cast<std::ptrdiff_t>(length)});
        EXPECT_THROW(Tree::open(tree()), Error) << length;
    }
    index.push_back(std::byte('x'));
    write_file(index_path(), index);
    EXPECT_THROW(Tree::open(tree()), Error);
}

TEST_F(TreeTest, IdentityIsTheWayFromTheRoot)
{
    build(20000, 1000);
    const auto tree = Tree::open(this->tree());
    EXPECT_EQ(tree->part_roots(), std::vector<NodeId>{0});
    for (NodeId id = 0; id < tree->nodes().size(); ++id) {
        const ChunkIdentity identity = tree->identity(id);
        EXPECT_EQ(identity.path.depth, tree->node(id).depth);
        EXPECT_EQ(identity.generation, 1u);
        NodeId at = 0;
        for (std::uint16_t d = 0; d < identity.path.depth; ++d)
            at = tree->node(at).children[identity.path.bits[d / 64] >> (d % 64) & 1];
        EXPECT_EQ(at, id);
    }
}

TEST_F(TreeTest, PartsOfChunksAreTheFilteredWhole)
{
    build(60000, 12000);
    const auto tree = Tree::open(this->tree());
    const ColumnSet columns = ColumnSet::all(tree->info().schema);
    std::mt19937_64 random(7);
    for (int round = 0; round < 60; ++round) {
        const auto id = static_cast<NodeId>(random() % tree->nodes().size());
        const Chunk whole = tree->read_chunk(id, columns);
        if (whole.points == 0) continue;
        Box3i box;
        for (int corner = 0; corner < 2; ++corner) box.extend(whole.positions->grid(random() % whole.points));
        const std::size_t level = tree->node(id).first_level + random() % (tree->node(id).level_points.size() + 1);
        const ChunkPart part = tree->read_chunk_part(id, columns, [&](const Box3i& b, std::uint16_t l) {
            bool apart = l > level;
            for (std::size_t a = 0; a < 3; ++a) apart = apart || b.min[a] > box.max[a] || b.max[a] < box.min[a];
            return !apart;
        });
        const std::uint32_t to_level = tree->node(id).points_to_level(level);
        std::vector<bool> kept(whole.points, false);
        std::size_t at = 0;
        for (std::size_t s = 0; s < part.first.size(); ++s)
            for (std::uint32_t i = part.first[s]; i < part.first[s] + part.count[s]; ++i, ++at) {
                ASSERT_LT(i, to_level);
                ASSERT_FALSE(kept[i]);
                kept[i] = true;
                ASSERT_EQ(part.chunk.positions->grid(at), whole.positions->grid(i));
                for (std::size_t k = 0; k < whole.attributes.size(); ++k) {
                    const std::size_t size = whole.attributes[k]->point_bytes();
                    ASSERT_EQ(std::memcmp(part.chunk.attributes[k]->data() + at * size,
                                          whole.attributes[k]->data() + i * size, size),
                              0);
                }
            }
        EXPECT_EQ(at, part.chunk.points);
        for (std::uint32_t i = 0; i < to_level; ++i)
            if (box.contains(whole.positions->grid(i))) ASSERT_TRUE(kept[i]) << "a point of the box is missing";
    }
}

// Every read counts: its points, its bytes as they are stored, and the columns that were decoded, which may be none.
TEST_F(TreeTest, CountsWhatIsRead)
{
    build(20000, 1000);
    const auto tree = Tree::open(this->tree());
    const Schema& schema = tree->info().schema;
    EXPECT_EQ(tree->reads().chunks, 0u);
    EXPECT_TRUE(names_of(tree->reads().columns, schema).empty());
    std::uint64_t points = 0;
    for (NodeId id = 0; id < tree->nodes().size(); ++id)
        points += tree->read_chunk(id, ColumnSet::only_positions()).points;
    const TreeReads positions = tree->reads();
    EXPECT_EQ(positions.points, tree->info().points);
    EXPECT_EQ(positions.points, points);
    EXPECT_EQ(names_of(positions.columns, schema), std::vector<std::string>{"positions"});
    for (NodeId id = 0; id < tree->nodes().size(); ++id) tree->read_chunk(id, ColumnSet::whole(schema));
    const TreeReads all = tree->reads();
    EXPECT_EQ(all.chunks, 2 * positions.chunks);
    EXPECT_EQ(all.columns, ColumnSet::whole(schema));
    // All columns of all chunks are the data files, less what they begin and end with.
    const std::uint64_t whole = all.bytes - positions.bytes;
    EXPECT_LT(positions.bytes, whole);
    EXPECT_LE(whole, tree->info().bytes);
    EXPECT_GT(whole, tree->info().bytes * 9 / 10);
    const ChunkPart part = tree->read_chunk_part(0, ColumnSet::only_positions(),
                                                 [](const Box3i&, std::uint16_t level) { return level == 0; });
    EXPECT_EQ(tree->reads().points - all.points, part.chunk.points);
    EXPECT_EQ(tree->reads().bytes - all.bytes, part.bytes_read);
    EXPECT_EQ(tree->with_schema(schema)->reads().chunks, tree->reads().chunks);
}

TEST_F(TreeTest, AClosedTreeLeavesNoFileOpen)
{
    build();
    const std::size_t before = open_descriptors();
    const LimitedDescriptors limit(12);
    for (int i = 0; i < 40; ++i) EXPECT_EQ(Tree::open(tree())->info().points, 20000u);
    EXPECT_EQ(open_descriptors(), before);
}

TEST_F(TreeTest, ATreeWithMoreAttributesSharesTheOpenFiles)
{
    build();
    auto tree = Tree::open(this->tree());
    const std::size_t before = open_descriptors();
    const LimitedDescriptors limit(4);
    Schema longer = tree->info().schema;
    longer.add({"height", ScalarType::f32, 1, 1, 0, ""});
    std::vector<std::shared_ptr<const Tree>> trees;
    for (int i = 0; i < 40; ++i) trees.push_back(tree->with_schema(longer));
    EXPECT_EQ(open_descriptors(), before);
    // The files stay open as long as any of the trees needs them.
    tree.reset();
    fs::remove_all(this->tree());
    for (const auto& one : trees) {
        const Chunk chunk = one->read_chunk(0, ColumnSet::all(longer));
        EXPECT_EQ(chunk.points, one->node(0).points);
        EXPECT_EQ(chunk.attributes.back()->value(0), 0);
    }
    trees.clear();
    EXPECT_LT(open_descriptors(), before);
}

}  // namespace
