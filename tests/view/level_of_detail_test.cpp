// Node selection against brute force over random trees.
#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <thread>

using namespace pcm;
using namespace pcm::test;

namespace {

// The definition, by repeated search over all nodes instead of a queue.
struct BruteForce {
    std::vector<NodeId> wanted;
    std::set<NodeId> beyond;
    bool budget_reached = false;
};

NodeId ancestor_with_points(const NodeTable& nodes, NodeId id)
{
    for (NodeId a = nodes[id].parent; a != no_node; a = nodes[a].parent)
        if (nodes[a].points > 0) return a;
    return no_node;
}

double error_of(const SyntheticTree& tree, const Frustum& frustum, NodeId id)
{
    if (ancestor_with_points(tree.nodes, id) == no_node) return std::numeric_limits<double>::infinity();
    return frustum.pixels(tree.nodes[tree.nodes[id].parent].spacing, tree.grid.to_source(tree.nodes[id].box));
}

BruteForce brute_force(const SyntheticTree& tree, const Camera& view, const DetailLimits& limits)
{
    BruteForce result;
    const auto frustum = Frustum::of(view);
    std::vector<bool> taken(tree.nodes.size(), false);
    std::uint64_t points = 0;
    std::uint64_t pages = 0;
    const auto open = [&](NodeId id) {
        const NodeId parent = tree.nodes[id].parent;
        return !taken[id] && (parent == no_node || taken[parent]) &&
               frustum->intersects(tree.grid.to_source(tree.nodes[id].box));
    };
    for (;;) {
        NodeId best = no_node;
        double best_error = limits.target_px;
        for (NodeId id = 0; id < tree.nodes.size(); ++id)
            if (open(id) && error_of(tree, *frustum, id) > best_error) {
                best = id;
                best_error = error_of(tree, *frustum, id);
            }
        if (best == no_node) break;
        const std::uint32_t n = tree.nodes[best].points;
        const std::uint64_t need = (n + limits.page_points - 1) / limits.page_points;
        if (n > 0 && (points + n > limits.point_budget || pages + need > limits.page_budget)) {
            result.budget_reached = true;
            break;
        }
        points += n;
        pages += need;
        taken[best] = true;
        if (n > 0) result.wanted.push_back(best);
    }
    for (NodeId id = 0; id < tree.nodes.size(); ++id)
        if (open(id)) result.beyond.insert(id);
    return result;
}

double error_of_drawn(const SyntheticTree& tree, const Camera& view, const std::set<NodeId>& drawn)
{
    // Any visible node that is not drawn shows its nearest drawn ancestors; empty nodes count as drawn when those are.
    const auto frustum = Frustum::of(view);
    double error = 0;
    for (NodeId id = 0; id < tree.nodes.size(); ++id) {
        bool reachable = true;  // all ancestors visible and drawn
        for (NodeId a = tree.nodes[id].parent; a != no_node && reachable; a = tree.nodes[a].parent)
            reachable = drawn.count(a) || tree.nodes[a].points == 0;
        if (!reachable || drawn.count(id) || tree.nodes[id].points == 0) continue;
        if (!frustum->intersects(tree.grid.to_source(tree.nodes[id].box))) continue;
        error = std::max(error, error_of(tree, *frustum, id));
    }
    return std::min(error, static_cast<double>(std::max(view.width, view.height)));
}

}  // namespace

class SelectDetail : public testing::TestWithParam<double> {};

TEST_P(SelectDetail, IsWhatBruteForceFinds)
{
    const double coordinate = GetParam();
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    std::size_t limited = 0;
    std::size_t partial = 0;
    for (int i = 0; i < 3000; ++i) {
        const SyntheticTree tree = random_tree(random, 2 + random() % 250, {coordinate, coordinate, 0});
        // In every third case the eye is somewhere inside the root's box.
        const double spread = i % 3 == 0 ? 1 : 3;
        const Box3d bounds = tree.grid.to_source(tree.nodes[0].box);
        Vec3d eye = bounds.centre();
        for (std::size_t a = 0; a < 3; ++a) eye[a] += spread * (unit(random) - 0.5) * bounds.extent(a);
        const Vec3d origin = i % 2 ? tree.grid.offset : Vec3d{0, 0, 0};
        const Camera view = random_view(random, eye, origin, 100);
        DetailLimits limits;
        limits.target_px = std::pow(10.0, 3 * unit(random) - 1);
        limits.point_budget = i % 4 == 0 ? random() % 200000 : 1000000000;
        limits.page_points = 1000;
        if (i % 4 == 1) limits.page_budget = random() % 300;

        const DetailSelection selection = select_detail(tree.nodes, tree.grid, view, limits);
        const BruteForce expected = brute_force(tree, view, limits);
        ASSERT_EQ(selection.wanted.size(), expected.wanted.size()) << "case " << i;
        std::uint64_t points = 0;
        std::uint64_t pages = 0;
        for (std::size_t k = 0; k < expected.wanted.size(); ++k) {
            const DetailNode& node = selection.wanted[k];
            ASSERT_EQ(node.node, expected.wanted[k]) << "case " << i << ", place " << k;
            const NodeId ancestor = ancestor_with_points(tree.nodes, node.node);
            if (node.ancestor == no_ancestor) {
                EXPECT_EQ(ancestor, no_node);
            } else {
                EXPECT_LT(node.ancestor, k);
                EXPECT_EQ(selection.wanted[node.ancestor].node, ancestor);
            }
            points += tree.nodes[node.node].points;
            pages += (tree.nodes[node.node].points + 999) / 1000;
        }
        EXPECT_EQ(points, selection.wanted_points);
        EXPECT_LE(points, limits.point_budget);
        EXPECT_LE(pages, limits.page_budget);
        EXPECT_EQ(selection.budget_reached, expected.budget_reached);
        limited += selection.budget_reached;
        std::set<NodeId> beyond;
        for (const DetailNode& node : selection.beyond) beyond.insert(node.node);
        EXPECT_EQ(beyond, expected.beyond) << "case " << i;

        // What can be drawn while some chunks are missing.
        std::set<NodeId> resident;
        for (const DetailNode& node : selection.wanted)
            if (unit(random) < (i % 5) * 0.25) resident.insert(node.node);
        const DrawSet set = choose_drawable(selection, [&](const DetailNode& n) { return resident.count(n.node) > 0; });
        std::set<NodeId> drawn;
        for (const std::uint32_t k : set.drawn) {
            const NodeId id = selection.wanted[k].node;
            EXPECT_TRUE(resident.count(id));
            for (NodeId a = tree.nodes[id].parent; a != no_node; a = tree.nodes[a].parent)
                EXPECT_TRUE(tree.nodes[a].points == 0 || drawn.count(a)) << "drawn before its ancestor";
            drawn.insert(id);
        }
        for (const DetailNode& node : selection.wanted) {
            bool expect_drawn = resident.count(node.node) > 0;
            for (NodeId a = tree.nodes[node.node].parent; a != no_node; a = tree.nodes[a].parent)
                expect_drawn = expect_drawn && (tree.nodes[a].points == 0 || resident.count(a));
            EXPECT_EQ(drawn.count(node.node) > 0, expect_drawn);
        }
        EXPECT_EQ(set.missing.size(), selection.wanted.size() - resident.size());
        partial += !set.missing.empty() && !set.drawn.empty();
        // Empty nodes left in `beyond` count as an error too, which the oracle below ignores.
        bool empty_beyond = false;
        for (const DetailNode& node : selection.beyond) empty_beyond |= tree.nodes[node.node].points == 0;
        if (!empty_beyond) {
            EXPECT_EQ(set.error_px, error_of_drawn(tree, view, drawn)) << "case " << i;
        }
    }
    EXPECT_GT(limited, 200u);
    EXPECT_GT(partial, 200u);
}

INSTANTIATE_TEST_SUITE_P(Coordinates, SelectDetail, testing::Values(0.0, 5e6));

TEST(SelectDetail, AViewThatShowsNothingWantsNothing)
{
    Camera view;
    view.modelview = identity();
    view.projection = orthographic(1, 1, -1, 1);
    view.width = view.height = 10;
    view.projection[10] = std::numeric_limits<double>::infinity();
    std::mt19937_64 random(4);
    EXPECT_TRUE(select_detail(random_tree(random, 10, {}).nodes, Grid{}, view, {}).wanted.empty());
}

TEST(SelectDetail, TheErrorOfAFullPictureIsZeroAndOfTheTargetBelowIt)
{
    std::mt19937_64 random(6);
    const SyntheticTree tree = random_tree(random, 500, {5e6, 5e6, 0});
    Camera view;
    view.origin = tree.grid.offset;
    view.width = 800;
    view.height = 600;
    view.modelview = translation({-100, -75, -200});
    view.projection = perspective(-0.4, 0.4, -0.3, 0.3, 0.5, 2000);
    const auto all = [](const DetailNode&) { return true; };
    DetailLimits limits;
    limits.target_px = 0;
    EXPECT_EQ(choose_drawable(select_detail(tree.nodes, tree.grid, view, limits), all).error_px, 0);
    for (const double target : {0.5, 1.0, 3.0, 20.0}) {
        limits.target_px = target;
        const DetailSelection selection = select_detail(tree.nodes, tree.grid, view, limits);
        EXPECT_LE(choose_drawable(selection, all).error_px, target);
    }
    const auto none = [](const DetailNode&) { return false; };
    EXPECT_EQ(choose_drawable(select_detail(tree.nodes, tree.grid, view, limits), none).error_px, 800);
}

TEST(SelectDetail, AnyThreadGetsTheSame)
{
    std::mt19937_64 random(7);
    const SyntheticTree tree = random_tree(random, 3000, {5e6, 5e6, 0});
    Camera view = random_view(random, tree.grid.to_source(tree.nodes[0].box).centre(), tree.grid.offset, 100);
    const DetailSelection reference = select_detail(tree.nodes, tree.grid, view, {});
    std::vector<DetailSelection> results(8);
    std::vector<std::thread> threads;
    for (auto& result : results) threads.emplace_back([&] { result = select_detail(tree.nodes, tree.grid, view, {}); });
    for (auto& thread : threads) thread.join();
    for (const auto& result : results) {
        ASSERT_EQ(result.wanted.size(), reference.wanted.size());
        for (std::size_t i = 0; i < result.wanted.size(); ++i) {
            EXPECT_EQ(result.wanted[i].node, reference.wanted[i].node);
            EXPECT_EQ(result.wanted[i].error_px, reference.wanted[i].error_px);
        }
    }
}
