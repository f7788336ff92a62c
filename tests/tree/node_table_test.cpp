// Nodes that are read page by page are those of the whole index, and what is wrong with one is found when it is used.
#include "pcm/tree/node_table.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/tree/damage.h"
#include "pcm/tree/index_head.h"
#include "pcm/tree/node_order.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/verify.h"
#include "tests/support.h"
#include "tests/tree/small_tree.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <random>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// A tree of random shape whose nodes have one point each, and two levels; part 0 is all of it.
TreeIndex random_index(std::mt19937_64& random, std::size_t size)
{
    std::vector<std::array<std::size_t, 2>> children(size, {0, 0});  // 0: none
    for (std::size_t id = 1; id < size;) {
        const std::size_t above = random() % id, side = random() % 2;
        if (children[above][side] == 0) children[above][side] = id++;
    }
    TreeIndex index;
    index.nodes = linked_nodes(order_nodes<std::size_t>(1, 0, [&](std::size_t item, unsigned side) {
        return children[item - 1][side] ? children[item - 1][side] + 1 : 0;
    }));
    index.info.points = size;
    index.info.spacings = {1, 0};
    index.info.levels = 2;
    index.info.box = {{0, 0, 0}, {9, 9, 9}};
    index.data_files = {{1 << 20, 1}};
    for (NodeId id = 0; id < size; ++id) {
        Node& node = index.nodes[id];
        node.points = 1;
        node.first_level = static_cast<std::uint16_t>(random() % 2);
        node.level_points = {1};
        node.box = index.info.box;
        node.extent = {0, id, 1, 1};
        node.subtree_points = 1;
    }
    for (std::size_t id = size; id-- > 1;)
        index.nodes[index.nodes[id].parent].subtree_points += index.nodes[id].subtree_points;
    return index;
}

bool same(const Node& a, const Node& b)
{
    return a.parent == b.parent && a.children == b.children && a.depth == b.depth && a.part == b.part &&
           a.first_level == b.first_level && a.points == b.points && a.level_points == b.level_points &&
           a.subtree_points == b.subtree_points && a.box == b.box && a.spacing == b.spacing && a.extent == b.extent;
}

class NodeTableTest : public testing::Test {
protected:
    fs::path path() const { return folder_ / index_file_name; }
    OpenIndex open(const std::vector<std::byte>& bytes) const
    {
        write_file(path(), bytes);
        return open_index(std::make_shared<const File>(path(), File::Mode::read));
    }

    TemporaryFolder folder_;
};

TEST_F(NodeTableTest, PagesInAnyOrderGiveTheNodesOfTheWhole)
{
    std::mt19937_64 random(1);
    for (int round = 0; round < 60; ++round) {
        TreeIndex index = random_index(random, 1 + random() % 400);
        const std::uint32_t nodes_a_page = 1 + random() % 40;
        index.pages = pages_of(nodes_a_page, index.nodes.size());
        const std::vector<std::byte> bytes = encode_index(index);
        const TreeIndex whole = decode_index(bytes, "index");
        const OpenIndex opened = open(bytes);
        ASSERT_EQ(opened.nodes.size(), whole.nodes.size());
        EXPECT_EQ(opened.nodes.pages_loaded(), 1u);
        EXPECT_EQ(opened.nodes.pages(), index.pages.size());
        std::vector<NodeId> order(index.nodes.size());
        for (NodeId id = 0; id < order.size(); ++id) order[id] = id;
        std::shuffle(order.begin(), order.end(), random);
        for (const NodeId id : order) ASSERT_TRUE(same(opened.nodes[id], whole.nodes[id])) << id;
        EXPECT_EQ(opened.nodes.pages_loaded(), opened.nodes.pages());
        NodeId id = 0;
        for (const Node& node : opened.nodes) ASSERT_TRUE(same(node, whole.nodes[id++]));
        EXPECT_THROW(opened.nodes.at(id), std::out_of_range);
        EXPECT_EQ(opened.head->levels.back().points_to_here, index.info.points);
        for (std::size_t k = 0; k < 2; ++k)
            EXPECT_EQ(static_cast<std::ptrdiff_t>(opened.head->levels[k].nodes),
                      std::count_if(whole.nodes.begin(), whole.nodes.end(),
                                    [&](const Node& node) { return node.first_level == k; }));
    }
}

// The way from the root to a leaf of a large tree: a page for every ten depths.
TEST_F(NodeTableTest, TheWayToALeafNeedsFewPages)
{
    constexpr std::size_t size = (1u << 17) - 1;  // a full tree of 17 depths
    TreeIndex index;
    index.nodes = linked_nodes(order_nodes<std::size_t>(
        1, 0, [&](std::size_t item, unsigned side) { return 2 * item + side <= size ? 2 * item + side : 0; }));
    index.info.points = size;
    index.info.spacings = {0};
    index.info.levels = 1;
    index.info.box = {{0, 0, 0}, {9, 9, 9}};
    index.data_files = {{1 << 20, 1}};
    for (std::size_t id = size; id-- > 0;) {
        Node& node = index.nodes[id];
        node.points = 1;
        node.level_points = {1};
        node.box = index.info.box;
        node.extent = {0, id, 1, 1};
        node.subtree_points += 1;
        if (id > 0) index.nodes[node.parent].subtree_points += node.subtree_points;
    }
    const std::vector<std::byte> bytes = encode_index(index);
    std::mt19937_64 random(2);
    for (int way = 0; way < 20; ++way) {
        const OpenIndex opened = open(bytes);
        ASSERT_EQ(opened.nodes.pages(), 129u);  // the top, and eight subtrees of 127 nodes a page
        NodeId id = 0;
        while (!opened.nodes[id].is_leaf()) id = opened.nodes[id].children[random() % 2];
        EXPECT_EQ(opened.nodes[id].depth, 16);
        EXPECT_EQ(opened.nodes.pages_loaded(), 2u);
    }
}

TEST_F(NodeTableTest, ManyThreadsReadEachPageOnce)
{
    std::mt19937_64 random(3);
    TreeIndex index = random_index(random, 5000);
    index.pages = pages_of(8, 5000);
    const std::vector<std::byte> bytes = encode_index(index);
    const TreeIndex whole = decode_index(bytes, "index");
    const OpenIndex opened = open(bytes);
    fs::remove(path());  // the table keeps its file
    std::atomic<std::size_t> wrong{0};
    std::vector<std::thread> crew;
    for (unsigned t = 0; t < 4; ++t)
        crew.emplace_back([&, t] {
            std::mt19937_64 own(t);
            for (int i = 0; i < 20000; ++i) {
                const auto id = static_cast<NodeId>(own() % 5000);
                if (!same(opened.nodes[id], whole.nodes[id])) ++wrong;
            }
        });
    for (std::thread& thread : crew) thread.join();
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(opened.nodes.pages_loaded(), 625u);
}

// The bytes with checksums that match them: of the pages, as long as the head says where they are, and of the head.
std::vector<std::byte> sealed(std::vector<std::byte> bytes, const IndexHead& head)
{
    const std::size_t head_bytes = bytes.size() - (head.file_bytes - head.pages[0].offset);
    const std::size_t table = head_bytes - 8 - 20 * head.pages.size();
    for (std::size_t page = 0; page < head.pages.size(); ++page) {
        const NodePage& at = head.pages[page];
        const std::uint64_t sum = checksum(bytes.data() + at.offset, at.bytes);
        if (sum != at.checksum) std::memcpy(bytes.data() + table + 20 * page + 12, &sum, 8);
    }
    const std::uint64_t sum = checksum(bytes.data(), head_bytes - 8);
    std::memcpy(bytes.data() + head_bytes - 8, &sum, 8);
    return bytes;
}

// The nodes that are walked from the root, in an order of the walker's own. Each was a child of one node.
std::size_t walk(const NodeTable& nodes, std::mt19937_64& random)
{
    std::vector<NodeId> open;
    if (!nodes.empty()) open.push_back(0);
    std::size_t walked = 0;
    while (!open.empty()) {
        std::swap(open[random() % open.size()], open.back());
        const NodeId id = open.back();
        open.pop_back();
        const Node& node = nodes[id];
        EXPECT_LE(++walked, nodes.size());
        if (walked > nodes.size()) return walked;
        for (const NodeId child : node.children)
            if (child != no_node) open.push_back(child);
    }
    return walked;
}

// Any byte is changed and the checksums adapted: what is refused as a whole is refused page by page as well, by the
// time all has been used, whatever the order; what is accepted is encoded as the same bytes.
TEST_F(NodeTableTest, AnyByteChangedIsRefusedOrDecodedAsItStands)
{
    std::mt19937_64 random(4);
    TreeIndex index = random_index(random, 9);
    index.info.schema.add({"intensity", ScalarType::u16, 1, 1.0, 0.0, "raw"});
    index.info.metadata = {{"key", {std::byte{1}}}};
    index.info.sources = {"a.las"};
    index.pages = pages_of(2, 9);
    const std::vector<std::byte> bytes = encode_index(index);
    const IndexHead head = decode_head(bytes, "index");
    std::size_t refused = 0;
    for (std::size_t at = 0; at < bytes.size(); ++at)
        for (const unsigned change : {1u, 2u, 128u, 255u}) {
            auto changed = bytes;
            changed[at] ^= static_cast<std::byte>(change);
            changed = sealed(std::move(changed), head);
            std::string why;
            try {
                EXPECT_EQ(encode_index(decode_index(changed, "index")), changed) << at;
            } catch (const Error& error) {
                why = error.what();
                ++refused;
            }
            try {
                const OpenIndex opened = open(changed);
                walk(opened.nodes, random);
                opened.nodes.all();
                // What a level has in all is known when every page has been read; verify compares it.
                EXPECT_TRUE(why.empty() || why.find("the points of its nodes") != std::string::npos) << at << why;
            } catch (const Error& error) {
                EXPECT_FALSE(why.empty()) << at << error.what();
            }
        }
    EXPECT_GT(refused, 2 * bytes.size());
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const std::vector<std::byte> shorter(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
        EXPECT_THROW(decode_index(shorter, "index"), Error) << length;
        EXPECT_THROW(open(shorter), Error) << length;
    }
}

// What a head says that no page can check.
class FalseHead : public NodeTableTest {
protected:
    FalseHead()
    {
        std::mt19937_64 random(6);
        TreeIndex index = random_index(random, 50);
        index.pages = {20, 30};
        const std::vector<std::byte> bytes = encode_index(index);
        head_ = decode_head(bytes, "index");
        pages_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(head_.pages[0].offset), bytes.end());
    }
    OpenIndex opened() const
    {
        std::vector<std::byte> bytes = encode_head(head_);
        bytes.insert(bytes.end(), pages_.begin(), pages_.end());
        return open(bytes);
    }
    IndexHead head_;
    std::vector<std::byte> pages_;
};

TEST_F(FalseHead, LevelsThatDoNotAddUpAreRefused)
{
    EXPECT_EQ(opened().head->levels[1].points_to_here, 50u);
    ++head_.levels[0].points;
    EXPECT_THROW(opened(), Error);
    --head_.levels[1].points;
    EXPECT_EQ(opened().head->levels[1].points_to_here, 50u);
}

// Their sum is right, as it wraps around.
TEST_F(FalseHead, PagesLargerThanAnyFileAreRefused)
{
    for (NodePage& page : head_.pages) page.bytes += std::uint64_t(1) << 63;
    EXPECT_THROW(opened(), Error);
}

// Nodes that name a child of another one, in pages that are read in any order: the walk ends with an error, and visits
// no node twice before.
TEST_F(NodeTableTest, AFalseChildInAnotherPageIsFoundInAnyOrder)
{
    std::mt19937_64 random(5);
    for (int round = 0; round < 200; ++round) {
        TreeIndex index = random_index(random, 60);
        index.pages = pages_of(1 + static_cast<std::uint32_t>(random() % 4), 60);
        NodeId liar = no_node, child = no_node;
        for (int tries = 0; tries < 1000 && liar == no_node; ++tries) {
            const auto id = static_cast<NodeId>(random() % 60);
            const auto below = static_cast<NodeId>(id + 1 + random() % 59);
            if (below >= 60 || index.nodes[id].children[1] != no_node || index.nodes[id].children[0] == below) continue;
            liar = id;
            child = below;
        }
        ASSERT_NE(liar, no_node);
        index.nodes[liar].children[1] = child;
        for (NodeId up = liar;; up = index.nodes[up].parent) {  // with a true sum, so that the sum finds nothing
            index.nodes[up].subtree_points += index.nodes[child].subtree_points;
            if (up == 0) break;
        }
        index.info.points = index.nodes[0].subtree_points;
        const std::vector<std::byte> bytes = encode_index(index);
        EXPECT_THROW(decode_index(bytes, "index"), Error);
        bool found = false;
        try {
            const OpenIndex opened = [&] {
                write_file(path(), bytes);
                const auto file = std::make_shared<const File>(path(), File::Mode::read);
                std::vector<std::byte> beginning = read_beginning(*file);
                auto head = std::make_shared<IndexHead>(decode_head(beginning, path()));
                return OpenIndex{head, NodeTable(head, file, beginning)};
            }();
            walk(opened.nodes, random);
        } catch (const Error& error) {
            found = true;
            EXPECT_NE(std::string(error.what()).find("child"), std::string::npos) << error.what();
        }
        EXPECT_TRUE(found);
    }
}

class DamagedPage : public SmallTree {};

TEST_F(DamagedPage, IsFoundWhenItIsUsed)
{
    build();
    TreeIndex index = this->index();
    index.pages = pages_of(2, index.nodes.size());
    std::vector<std::byte> bytes = encode_index(index);
    bytes[bytes.size() - 20] ^= std::byte{1};
    write_file(index_path(), bytes);
    const auto tree = Tree::open(this->tree());
    EXPECT_EQ(tree->level_summaries().back().points_to_here, 20000u);
    for (int tries = 0; tries < 2; ++tries) try {
            tree->nodes().back();
            ADD_FAILURE() << "read";
        } catch (const DamagedTree& error) {
            EXPECT_NE(std::string(error.what()).find("pcmlab repair"), std::string::npos) << error.what();
        }
    EXPECT_EQ(tree->nodes().front().subtree_points, 20000u);
    EXPECT_THROW(verify_tree(this->tree(), 1), DamagedTree);
}

}  // namespace
