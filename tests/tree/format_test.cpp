// What is on disk of a tree: parts, segments, many data files, and damage that only verifying finds.

#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_header.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/support.h"
#include "pcm/tree/about.h"
#include "pcm/build/builder.h"
#include "pcm/tree/data_file_pool.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/verify.h"

#include <sys/resource.h>

#include <atomic>
#include <fstream>
#include <random>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

std::vector<std::byte> read_file(const fs::path& path)
{
    const File file(path, File::Mode::read);
    std::vector<std::byte> bytes(file.size());
    file.read_at(bytes.data(), bytes.size(), 0);
    return bytes;
}

void write_file(const fs::path& path, const std::vector<std::byte>& bytes)
{
    fs::remove(path);
    File(path, File::Mode::create_new).write_at(bytes.data(), bytes.size(), 0);
}

class FormatTest : public testing::Test {
protected:
    void build(std::size_t points, std::uint32_t chunk_points)
    {
        write_las(folder_ / "in.las", records(Shape::surface, points, 3), {{0.01, 0.01, 0.01}, {500000, 4800000, 0}});
        BuildOptions options;
        options.chunk_points = chunk_points;
        build_tree({folder_ / "in.las"}, tree(), options);
    }
    fs::path tree() const { return folder_ / "out.pct"; }
    fs::path index_path() const { return tree() / index_file_name; }
    TreeIndex index() const { return decode_index(read_file(index_path()), "index"); }
    void write_index(const TreeIndex& index) const { write_file(index_path(), encode_index(index)); }

    // Every chunk into a data file of its own.
    std::size_t scatter() const
    {
        TreeIndex index = this->index();
        std::vector<std::vector<std::byte>> files;
        for (std::uint32_t i = 0; i < index.data_files.size(); ++i)
            files.push_back(read_file(tree() / data_file_name(i)));
        std::vector<DataFile> data_files;
        for (Node& node : index.nodes) {
            if (!node.extent.bytes) continue;
            const auto from = files[node.extent.file].begin() + static_cast<std::ptrdiff_t>(node.extent.offset);
            node.extent.file = static_cast<std::uint32_t>(data_files.size());
            node.extent.offset = 0;
            write_file(tree() / data_file_name(node.extent.file),
                       {from, from + static_cast<std::ptrdiff_t>(node.extent.bytes)});
            data_files.push_back({node.extent.bytes, 1});
        }
        index.data_files = std::move(data_files);
        write_index(index);
        return index.data_files.size();
    }
    TemporaryFolder folder_;
};

std::size_t open_descriptors()
{
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator("/proc/self/fd")) ++count;
    return count - 1;  // without the one that looks
}

TEST_F(FormatTest, ManyDataFilesKeepFewOpen)
{
    build(200000, 1000);
    const std::size_t files = scatter();
    ASSERT_GT(files, 150u);
    const std::size_t before = open_descriptors();
    rlimit old{};
    ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &old), 0);
    rlimit low = old;
    low.rlim_cur = before + 16;
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &low), 0);
    std::atomic<std::uint64_t> points{0};
    std::atomic<bool> failed{false};
    std::size_t after = 0;
    {
        const auto tree = Tree::open(this->tree(), 8);
        std::vector<std::thread> crew;
        for (unsigned t = 0; t < 4; ++t)
            crew.emplace_back([&, t] {
                try {
                    std::mt19937_64 random(t);
                    const std::size_t nodes = tree->nodes().size();
                    for (std::size_t i = t; i < nodes; i += 4) {
                        points += tree->read_chunk(static_cast<NodeId>(i), ColumnSet::only_positions()).points;
                        tree->read_chunk(static_cast<NodeId>(random() % nodes), ColumnSet::only_positions());
                    }
                } catch (const std::exception&) {
                    failed = true;
                }
            });
        for (std::thread& thread : crew) thread.join();
        after = open_descriptors();
        EXPECT_EQ(points, tree->info().points);
    }
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &old), 0);
    EXPECT_FALSE(failed);
    EXPECT_LE(after, before + 8);
    EXPECT_EQ(open_descriptors(), before);
    EXPECT_TRUE(verify_tree(tree(), 2).faults.empty());
}

// Of many calls, the pool holds the last used.
TEST_F(FormatTest, ThePoolClosesWhatWasNotUsedForLongest)
{
    std::vector<DataFile> files;
    for (std::uint32_t i = 0; i < 12; ++i) {
        write_file(folder_ / data_file_name(i), {std::byte(i)});
        files.push_back({1, 1});
    }
    files.push_back({0, 1});  // no such file, and none is needed
    DataFilePool pool(folder_.path(), files, 4);
    std::mt19937_64 random(1);
    std::vector<std::uint32_t> used;  // naive model, last used first
    std::vector<std::weak_ptr<const File>> seen(12);
    for (int round = 0; round < 2000; ++round) {
        const auto number = static_cast<std::uint32_t>(random() % 12);
        const bool was_open = !seen[number].expired();
        const auto it = std::find(used.begin(), used.end(), number);
        ASSERT_EQ(was_open, it != used.end()) << round;
        if (it != used.end()) used.erase(it);
        used.insert(used.begin(), number);
        if (used.size() > 4) used.pop_back();
        const auto file = pool.get(number);
        seen[number] = file;
        std::byte first;
        file->read_at(&first, 1, 0);
        ASSERT_EQ(first, std::byte(number));
        ASSERT_EQ(pool.open_files(), used.size());
    }
}

TEST_F(FormatTest, PartsOfChunksAreTheFilteredWhole)
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

TEST_F(FormatTest, IdentityIsTheWayFromTheRoot)
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
        try {
            decode_index(encode_index(changed), "index");
            ADD_FAILURE() << "not refused: " << why;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
        }
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

// Whatever byte changes while the checksum holds: an error, or an index that says just that.
TEST(TreeParts, AnIndexWithAnyByteChangedIsRefusedOrMeantSo)
{
    TreeIndex index = two_parts();
    index.info.schema.add({"intensity", ScalarType::u16, 1, 1.0, 0.0, "raw"});
    index.info.metadata = {{"key", {std::byte{1}}}};
    index.info.sources = {"a.las"};
    const auto bytes = encode_index(index);
    const auto sealed = [](std::vector<std::byte> changed) {
        if (changed.size() < 8) return changed;
        const std::uint64_t sum = checksum(changed.data(), changed.size() - 8);
        std::memcpy(changed.data() + changed.size() - 8, &sum, 8);
        return changed;
    };
    std::size_t refused = 0;
    for (std::size_t at = 0; at + 8 < bytes.size(); ++at)
        for (const unsigned change : {1u, 2u, 128u, 255u}) {
            auto changed = bytes;
            changed[at] ^= static_cast<std::byte>(change);
            changed = sealed(changed);
            try {
                EXPECT_EQ(encode_index(decode_index(changed, "index")), changed) << at;
            } catch (const Error&) {
                ++refused;
            }
        }
    EXPECT_GT(refused, bytes.size());
    for (std::size_t length = 0; length < bytes.size(); ++length)
        EXPECT_THROW(
            decode_index(sealed({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}), "index"), Error)
            << length;
}

TEST_F(FormatTest, AboutSaysWhatTheIndexSays)
{
    build(3000, 1000);
    const TreeInfo info = index().info;
    EXPECT_TRUE(same_info(read_about(tree()), info));
    const auto good = read_file(tree() / about_file_name);
    for (std::size_t at = 0; at < good.size(); ++at) {
        auto bad = good;
        bad[at] ^= std::byte(0x20);
        write_file(tree() / about_file_name, bad);
        EXPECT_THROW(read_about(tree()), Error) << at;
    }
    for (std::size_t length = 0; length < good.size(); length += 5) {
        write_file(tree() / about_file_name, {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)});
        EXPECT_THROW(read_about(tree()), Error) << length;
    }
}

TEST_F(FormatTest, VerifyLooksAroundTheIndex)
{
    build(3000, 1000);
    const auto names = [](const std::vector<std::string>& lines, const std::string& what) {
        return lines.size() == 1 && lines[0].find(what) != std::string::npos;
    };
    VerifyReport report = verify_tree(tree(), 1);
    EXPECT_TRUE(report.faults.empty() && report.around.empty() && report.notes.empty());

    TreeInfo info = index().info;
    info.sources.push_back("another.las");
    write_about(tree(), info);
    EXPECT_TRUE(names(verify_tree(tree(), 1).around, "not say what the index says"));
    info.generation = 2;
    write_about(tree(), info);
    report = verify_tree(tree(), 1);
    EXPECT_TRUE(report.around.empty());
    EXPECT_TRUE(names(report.notes, "interrupted"));
    info.generation = 3;
    write_about(tree(), info);
    EXPECT_TRUE(names(verify_tree(tree(), 1).around, "generation 3"));
    fs::remove(tree() / about_file_name);
    EXPECT_TRUE(names(verify_tree(tree(), 1).around, about_file_name));
    write_about(tree(), index().info);

    write_file(tree() / "chunks-007.bpc", {});
    EXPECT_TRUE(names(verify_tree(tree(), 1).notes, "chunks-007.bpc"));
    fs::remove(tree() / "chunks-007.bpc");

    const auto good = read_file(tree() / data_file_name(0));
    auto longer = good;
    longer.resize(longer.size() + 3);
    write_file(tree() / data_file_name(0), longer);
    EXPECT_TRUE(names(verify_tree(tree(), 1).notes, "3 bytes behind"));
    auto damaged = good;
    damaged[damaged.size() - 20] ^= std::byte(1);  // of the record at its end
    write_file(tree() / data_file_name(0), damaged);
    report = verify_tree(tree(), 1);
    EXPECT_TRUE(report.faults.empty());
    EXPECT_TRUE(names(report.notes, "commit record"));
    write_file(tree() / data_file_name(0), good);
    report = verify_tree(tree(), 1);
    EXPECT_TRUE(report.faults.empty() && report.around.empty() && report.notes.empty());
}

// A chunk that a program gone wrong has written: all checksums hold, and yet a box, a path or a generation is not true.
TEST_F(FormatTest, VerifyFindsWhatChecksumsCannot)
{
    build(20000, 20000);
    const TreeIndex index = this->index();
    const Extent extent = index.nodes[0].extent;
    const auto good = read_file(tree() / data_file_name(extent.file));
    const BpcHeader header = decode_header(good.data() + extent.offset, static_cast<std::size_t>(extent.bytes), {});
    ASSERT_GT(header.segments.size(), 2u);
    const auto changed = [&](std::size_t at, unsigned change) {
        auto bytes = good;
        std::byte* chunk = bytes.data() + extent.offset;
        chunk[at] ^= static_cast<std::byte>(change);
        const std::uint64_t sum = checksum(chunk, header.header_bytes - 8);
        std::memcpy(chunk + header.header_bytes - 8, &sum, 8);
        write_file(tree() / data_file_name(extent.file), bytes);
        return verify_tree(tree(), 1).faults;
    };
    for (const std::size_t at :
         {std::size_t(144), std::size_t(148), std::size_t(152), std::size_t(160)})  // part, generation, spacing, level
        EXPECT_FALSE(changed(at, 2).empty()) << at;
    // Boxes of segments: lower the smallest corner by what may be lowered without leaving the chunk's box.
    const std::size_t boxes = 164 + 4 * header.identity->level_points.size();
    std::size_t tried = 0;
    for (std::size_t s = 0; s < header.segments.size(); ++s) {
        const std::uint32_t low = static_cast<std::uint32_t>(header.segments[s].box.min[0] - header.box.min[0]);
        if (!(low & 1)) continue;
        const auto faults = changed(boxes + 24 * s, 1);
        ASSERT_EQ(faults.size(), 1u);
        EXPECT_NE(faults[0].find("not tight"), std::string::npos) << faults[0];
        ++tried;
    }
    EXPECT_GT(tried, 0u);
}

}  // namespace
