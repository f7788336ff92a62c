// The nodes that a selection touches, against a look at every point of every node.

#include "pcm/tree/selected_nodes.h"

#include "tests/tree/small_tree.h"

#include <algorithm>
#include <map>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

class SelectedNodesTest : public SmallTree {
protected:
    void SetUp() override
    {
        build(40000, 1000);
        tree_ = Tree::open(tree());
        for (NodeId id = 0; id < tree_->nodes().size(); ++id)
            chunks_.push_back(tree_->read_chunk(id, ColumnSet::only_positions()));
    }
    Vec3d position(NodeId id, std::uint32_t point) const
    {
        return tree_->info().grid.to_source(chunks_[id].positions->grid(point));
    }
    Vec3d any_position(std::mt19937_64& random) const
    {
        for (;;) {
            const auto id = static_cast<NodeId>(random() % chunks_.size());
            if (chunks_[id].points) return position(id, static_cast<std::uint32_t>(random() % chunks_[id].points));
        }
    }
    Selection random_selection(std::mt19937_64& random) const
    {
        Selection selection;
        const Vec3d a = any_position(random), b = any_position(random);
        const auto kind = random() % 4;
        if (kind != 1) {
            selection.box.emplace();
            selection.box->extend(a);
            selection.box->extend(b);
        }
        if (kind == 1 || kind == 2) selection.region = Region::sphere(a, std::hypot(a[0] - b[0], a[1] - b[1]) / 3);
        if (kind == 3) selection.where.push_back(parse_condition("x>" + std::to_string(b[0])));
        return selection;
    }

    std::shared_ptr<const Tree> tree_;
    std::vector<Chunk> chunks_;  // one per node
};

TEST_F(SelectedNodesTest, HoldEverySelectedPointAndNoOthersWhereAllAreSelected)
{
    std::mt19937_64 random(11);
    std::size_t inside = 0, skipped = 0;
    for (int round = 0; round < 60; ++round) {
        const Selector selector(random_selection(random), tree_->info().schema);
        std::optional<std::uint16_t> level;
        if (round % 3) level = static_cast<std::uint16_t>(random() % tree_->info().levels);
        std::map<NodeId, SelectedNode> nodes;
        NodeId last = 0;
        for (const SelectedNode& node : selected_nodes(*tree_, selector, level)) {
            EXPECT_TRUE(nodes.empty() || node.node > last) << "parents come first, each node once";
            last = node.node;
            nodes[node.node] = node;
            EXPECT_NE(node.relation, BoxRelation::outside);
        }
        for (NodeId id = 0; id < chunks_.size(); ++id) {
            const Node& node = tree_->node(id);
            const std::uint32_t points = level ? node.points_to_level(*level) : node.points;
            const auto found = nodes.find(id);
            if (found != nodes.end()) {
                EXPECT_EQ(found->second.points, points);
                inside += found->second.relation == BoxRelation::inside;
            } else {
                skipped += points > 0;
            }
            for (std::uint32_t i = 0; i < points; ++i) {
                const bool holds = selector.holds_at(position(id, i));
                ASSERT_TRUE(!holds || found != nodes.end()) << "node " << id << " has a selected point";
                if (found != nodes.end() && found->second.relation == BoxRelation::inside)
                    ASSERT_TRUE(holds) << "node " << id << " has a point that is not selected";
            }
        }
    }
    EXPECT_GT(inside, 20u);
    EXPECT_GT(skipped, 1000u);
}

TEST_F(SelectedNodesTest, TheGridBoxHasExactlyThePointsOfTheBox)
{
    std::mt19937_64 random(12);
    std::size_t in = 0, out = 0;
    for (int round = 0; round < 40; ++round) {
        Box3d box;
        box.extend(any_position(random));  // faces go through points
        box.extend(any_position(random));
        const Box3i grid = grid_box(*tree_, box);
        for (NodeId id = 0; id < chunks_.size(); ++id)
            for (std::uint32_t i = 0; i < chunks_[id].points; ++i) {
                const bool contained = box.contains(position(id, i));
                ASSERT_EQ(grid.contains(chunks_[id].positions->grid(i)), contained);
                ++(contained ? in : out);
            }
    }
    EXPECT_GT(in, 1000u);
    EXPECT_GT(out, 1000u);
    EXPECT_TRUE(grid_box(*tree_, Box3d()).empty());
    Box3d beside = tree_->info().bounds();
    beside.min[1] = beside.max[1] + 1;
    beside.max[1] += 2;
    EXPECT_TRUE(grid_box(*tree_, beside).empty());
    // Beyond all points, and infinite.
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(grid_box(*tree_, Box3d{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}),
              tree_->info().box);
}

// A box around floats is rounded as its points are, or a point on its face would be looked for in vain.
TEST(SourceBox, IsRoundedToFloatsWhereTheSourceHadFloats)
{
    const Grid grid{{0x1p-40, 0x1p-40, 0x1p-40}, {0, 0, 0}};
    const std::int64_t third = static_cast<std::int64_t>(0x1p40 / 3);
    const Box3i box{{third, third, third}, {third, third, third}};
    const double rounded = static_cast<double>(static_cast<float>(grid.to_source(third, 0)));
    EXPECT_NE(rounded, grid.to_source(third, 0));
    TreeInfo floats, doubles;
    floats.position_type = ScalarType::f32;
    for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_EQ(source_box(grid, box, SourceRounding(floats)).min[a], rounded);
        EXPECT_EQ(source_box(grid, box, SourceRounding(floats)).max[a], rounded);
    }
    EXPECT_EQ(source_box(grid, box, SourceRounding(doubles)).min[0], grid.to_source(third, 0));
}

}  // namespace
