#include "pcm/update/part_nodes.h"

#include "tests/update/model.h"

#include <cmath>
#include <random>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

// A part of nodes along random paths, each with a box of its own in a unit cell at (x, y).
void add_part(std::vector<PartNode>& nodes, std::uint32_t part, std::int64_t x, std::int64_t y, std::size_t count,
              std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::set<std::tuple<std::uint16_t, std::uint64_t>> taken;
    for (std::size_t n = 0; n < count; ++n) {
        PartNode node;
        node.part = part;
        const auto depth = n == 0 ? 0u : random() % 6;
        for (unsigned d = 0; d < depth; ++d) node.path = node.path.child(random() & 1);
        if (!taken.insert({node.path.depth, node.path.bits[0]}).second) continue;
        node.points = random() % 3 ? static_cast<std::uint32_t>(1 + random() % 100) : 0;
        if (n == 0) node.points = 1;
        if (node.points) {
            node.level_points = {node.points};
            node.first_level = static_cast<std::uint16_t>(depth);
            const auto at = [&](std::int64_t base) { return base + static_cast<std::int64_t>(random() % 1000); };
            node.box.extend(Vec3i{at(x), at(y), at(0)});
            node.box.extend(Vec3i{at(x), at(y), at(0)});
            node.extent.bytes = 100;
        }
        node.spacing = std::ldexp(8.0, -static_cast<int>(depth));
        nodes.push_back(node);
    }
}

TEST(PartNodes, JoinedPartsAreATree)
{
    for (const std::size_t parts : {1u, 2u, 3u, 7u, 64u}) {
        std::vector<PartNode> nodes;
        for (std::size_t part = 0; part < parts; ++part)
            add_part(nodes, static_cast<std::uint32_t>(3 * part), static_cast<std::int64_t>(part % 8) * 2000,
                     static_cast<std::int64_t>(part / 8) * 2000, 40, part);
        std::shuffle(nodes.begin(), nodes.end(), std::mt19937_64(parts));
        const NodeVector joined = join_parts(nodes, {16, 8, 4, 2, 1, 0.5, 0}, {0.1, 0.1, 0.1});
        ASSERT_EQ(joined.part_roots.size(), 3 * parts - 2);
        std::uint64_t points = 0, chunks = 0;
        Box3i box;
        for (const PartNode& node : nodes) {
            points += node.points;
            chunks += node.points > 0;
            box.extend(node.box);
        }
        ASSERT_FALSE(joined.nodes.empty());
        EXPECT_EQ(joined.nodes[0].subtree_points, points);
        EXPECT_EQ(joined.nodes[0].box, box);
        std::uint64_t own = 0, with_chunk = 0;
        for (NodeId id = 0; id < joined.nodes.size(); ++id) {
            const Node& node = joined.nodes[id];
            EXPECT_GT(node.subtree_points, 0u);
            EXPECT_TRUE(node.is_leaf() || node.spacing > 0);
            own += node.points;
            with_chunk += node.extent.bytes > 0;
            for (const NodeId child : node.children) {
                if (child == no_node) continue;
                EXPECT_GT(child, id);
                EXPECT_EQ(joined.nodes[child].parent, id);
                EXPECT_EQ(joined.nodes[child].depth, node.depth + 1);
                EXPECT_TRUE(node.box.contains(joined.nodes[child].box.min) &&
                            node.box.contains(joined.nodes[child].box.max));
            }
        }
        EXPECT_EQ(own, points);
        EXPECT_EQ(with_chunk, chunks);
        for (std::size_t k = 0; k < parts; ++k) {
            const NodeId root = joined.part_roots[3 * k];
            ASSERT_NE(root, no_node);
            EXPECT_EQ(joined.nodes[root].part, 3 * k);
            EXPECT_LE(joined.nodes[root].depth, std::ceil(std::log2(static_cast<double>(parts))));
        }
    }
}

TEST(PartNodes, NodesWithoutPointsBelowVanish)
{
    std::vector<PartNode> nodes(3);
    nodes[0].part = 0;
    nodes[1].part = 2;
    nodes[1].path = NodePath().child(1).child(0);
    nodes[1].points = 5;
    nodes[1].level_points = {5};
    nodes[1].box.extend(Vec3i{1, 2, 3});
    nodes[2].part = 2;
    nodes[2].path = NodePath().child(0);
    const NodeVector joined = join_parts(nodes, {4, 2, 0}, {1, 1, 1});
    ASSERT_EQ(joined.part_roots, (std::vector<NodeId>{no_node, no_node, 0}));
    ASSERT_EQ(joined.nodes.size(), 3u);  // two between the top and the one with points
    EXPECT_EQ(joined.nodes[0].children[0], no_node);
    EXPECT_EQ(joined.nodes[0].spacing, 8);
    EXPECT_EQ(joined.nodes[1].spacing, 8);
    EXPECT_EQ(joined.nodes[2].spacing, 0);
    EXPECT_EQ(joined.nodes[2].points, 5u);
    EXPECT_TRUE(join_parts({}, {1}, {1, 1, 1}).nodes.empty());
}

// Whoever follows a node's sides from the root arrives at it, also where the path needs both words of its bits.
TEST(PartNodes, PathsOfAnyLengthLeadToTheirNodes)
{
    std::mt19937_64 random(6);
    for (int round = 0; round < 30; ++round) {
        std::vector<PartNode> nodes;
        std::vector<std::vector<unsigned>> ways;
        std::vector<unsigned> way;  // the next one begins like the last one
        for (const std::size_t depth : {128u, 127u, 66u, 65u, 64u, 63u, 1u, 128u, 100u}) {
            way.resize(std::min({way.size(), depth, static_cast<std::size_t>(random() % 129)}));
            while (way.size() < depth) way.push_back(random() & 1);
            if (std::find(ways.begin(), ways.end(), way) != ways.end()) continue;
            ways.push_back(way);
            PartNode node;
            node.part = 1;
            for (const unsigned side : way) node.path = node.path.child(side);
            node.points = static_cast<std::uint32_t>(ways.size());
            node.level_points = {node.points};
            node.spacing = std::ldexp(8.0, -static_cast<int>(depth));
            node.box.extend(Vec3i{static_cast<std::int64_t>(ways.size()), 0, 0});
            nodes.push_back(std::move(node));
        }
        std::set<std::vector<unsigned>> prefixes;
        for (const auto& full : ways)
            for (std::size_t k = 0; k <= full.size(); ++k)
                prefixes.insert({full.begin(), full.begin() + std::ptrdiff_t(k)});
        std::shuffle(nodes.begin(), nodes.end(), random);
        const NodeVector joined = join_parts(nodes, {4, 0}, {1, 1, 1});
        EXPECT_EQ(joined.nodes.size(), prefixes.size());
        for (std::size_t k = 0; k < ways.size(); ++k) {
            NodeId at = joined.part_roots.at(1);
            for (const unsigned side : ways[k]) {
                at = joined.nodes[at].children[side];
                ASSERT_NE(at, no_node) << k;
            }
            EXPECT_EQ(joined.nodes[at].points, k + 1);
            EXPECT_EQ(joined.nodes[at].depth, ways[k].size());
        }
    }
}

TEST(PartNodes, OfATreeAreItsNodes)
{
    const TemporaryFolder folder;
    build(surface(30000, 0, 0, 100, 1), folder / "tree.pct");
    const auto tree = Tree::open(folder / "tree.pct");
    const NodeVector joined = join_parts(part_nodes(*tree), tree->info().spacings, tree->info().grid.scale);
    ASSERT_EQ(joined.nodes.size(), tree->nodes().size());
    for (NodeId id = 0; id < joined.nodes.size(); ++id) {
        const Node &a = joined.nodes[id], &b = tree->node(id);
        EXPECT_TRUE(a.parent == b.parent && a.children == b.children && a.depth == b.depth &&
                    a.first_level == b.first_level && a.points == b.points && a.level_points == b.level_points &&
                    a.subtree_points == b.subtree_points && a.box == b.box && a.spacing == b.spacing &&
                    a.extent == b.extent)
            << id;
    }
}

}  // namespace
