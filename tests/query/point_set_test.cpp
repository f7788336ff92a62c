#include "pcm/query/point_set.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <utility>

namespace {

using namespace pcm;
using namespace pcm::test;

class PointSetTest : public testing::Test {
protected:
    void SetUp() override
    {
        Grid grid;
        grid.scale = {0.01, 0.01, 0.01};
        write_las(folder_ / "in.las", records(Shape::surface, 5000, 3), grid);
        BuildOptions options;
        options.chunk_points = 1000;
        build_tree({folder_ / "in.las"}, folder_ / "out.pct", options);
        tree_ = Tree::open(folder_ / "out.pct");
    }
    using Model = std::set<std::pair<NodeId, std::uint32_t>>;
    // All points, none, or some of a node.
    std::vector<std::uint32_t> some(NodeId node)
    {
        std::vector<std::uint32_t> points;
        const unsigned share = static_cast<unsigned>(random_() % 4);
        for (std::uint32_t i = 0; i < tree_->node(node).points; ++i)
            if (random_() % 3 < share) points.push_back(i);
        return points;
    }
    void expect_equal(const PointSet& set, const Model& model)
    {
        EXPECT_EQ(set.size(), model.size());
        for (NodeId node = 0; node < tree_->nodes().size(); ++node) {
            const auto points = set.points(node);
            const auto flags = set.flags(node);
            EXPECT_EQ(set.count(node), points.size());
            EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
            for (std::uint32_t i = 0; i < tree_->node(node).points; ++i) {
                EXPECT_EQ(set.contains(node, i), model.count({node, i}) == 1);
                EXPECT_EQ(flags[i], model.count({node, i}));
            }
            EXPECT_FALSE(set.contains(node, tree_->node(node).points));
        }
    }
    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    std::mt19937 random_{7};
};

TEST_F(PointSetTest, OperationsAgainstASetOfPairs)
{
    for (int round = 0; round < 20; ++round) {
        PointSet a(tree_), b(tree_);
        Model ma, mb;
        for (auto& [set, model] : {std::pair<PointSet&, Model&>(a, ma), {b, mb}})
            for (NodeId node = 0; node < tree_->nodes().size(); ++node) {
                const auto points = some(node);
                set.set(node, points);
                for (const auto i : points) model.insert({node, i});
            }
        expect_equal(a, ma);
        PointSet result = a;
        Model expected;
        switch (round % 5) {
            case 0:
                result.combine(SetOperation::add, b);
                std::set_union(ma.begin(), ma.end(), mb.begin(), mb.end(), std::inserter(expected, expected.end()));
                break;
            case 1:
                result.combine(SetOperation::subtract, b);
                std::set_difference(ma.begin(), ma.end(), mb.begin(), mb.end(),
                                    std::inserter(expected, expected.end()));
                break;
            case 2:
                result.combine(SetOperation::intersect, b);
                std::set_intersection(ma.begin(), ma.end(), mb.begin(), mb.end(),
                                      std::inserter(expected, expected.end()));
                break;
            case 3:
                result.combine(SetOperation::replace, b);
                expected = mb;
                break;
            default:
                result.invert();
                for (NodeId node = 0; node < tree_->nodes().size(); ++node)
                    for (std::uint32_t i = 0; i < tree_->node(node).points; ++i)
                        if (!ma.count({node, i})) expected.insert({node, i});
        }
        expect_equal(result, expected);
        expect_equal(a, ma);  // copies share bits until they change
    }
}

TEST_F(PointSetTest, AllAndNoneCostNothing)
{
    const PointSet none(tree_), all = PointSet::all_of(tree_);
    EXPECT_EQ(all.size(), tree_->info().points);
    EXPECT_TRUE(none.empty());
    EXPECT_EQ(all.bytes(), none.bytes());
    PointSet again = all;
    again.invert();
    EXPECT_TRUE(again == none);
    EXPECT_FALSE(again == all);
    PointSet one(tree_);
    NodeId node = 0;
    while (tree_->node(node).points < 2) ++node;
    one.set(node, {1});
    EXPECT_LE(one.bytes(), none.bytes() + (tree_->node(node).points + 63) / 64 * 8);
}

TEST_F(PointSetTest, NumbersThatTheNodeDoesNotHaveAreRefused)
{
    PointSet set(tree_);
    EXPECT_THROW(set.set(0, {tree_->node(0).points}), Error);
    EXPECT_THROW(set.set(0, {2, 1}), Error);
    EXPECT_THROW(set.set(0, {1, 1}), Error);
    EXPECT_TRUE(set.empty());
}

TEST_F(PointSetTest, SetsOfAnotherTreeAreRefused)
{
    BuildOptions options;
    options.chunk_points = 1500;
    build_tree({folder_ / "in.las"}, folder_ / "other.pct", options);
    const PointSet other(Tree::open(folder_ / "other.pct"));
    PointSet set(tree_);
    EXPECT_THROW(set.combine(SetOperation::add, other), Error);
    EXPECT_FALSE(set.belongs_to(other.tree()));
    EXPECT_TRUE(set.belongs_to(*Tree::open(folder_ / "out.pct")));
}

}  // namespace
