// Node selection over several trees at once: one order by projected error, one budget; and hysteresis.
#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

using namespace pcm;
using namespace pcm::test;

namespace {

struct Scene {
    std::vector<SyntheticTree> trees;
    std::vector<TreeInView> in_view;
};

// Up to four trees, side by side or overlapping, each with its own origin.
Scene random_scene(std::mt19937_64& random)
{
    std::uniform_real_distribution<double> unit(0, 1);
    Scene scene;
    const std::size_t count = 1 + random() % 4;
    for (std::size_t t = 0; t < count; ++t)
        scene.trees.push_back(random_tree(random, 2 + random() % 80, {500000 + 100 * unit(random), 5000000, 0}));
    const Vec3d eye{500000 + 300 * unit(random), 5000000 + 200 * unit(random), 60 * unit(random)};
    const Camera view = random_view(random, eye, {500000, 5000000, 0}, 100);
    for (std::size_t t = 0; t < count; ++t) {
        Camera own = view;
        if (t % 2) {  // the same view from another local origin
            own.origin = {500100, 5000000, 0};
            own.modelview = product(view.modelview, translation({100, 0, 0}));
        }
        scene.in_view.push_back({&scene.trees[t].nodes, &scene.trees[t].grid, own});
    }
    return scene;
}

using Pick = std::pair<std::uint32_t, NodeId>;

NodeId ancestor_of(const NodeTable& nodes, NodeId id)
{
    for (NodeId a = nodes[id].parent; a != no_node; a = nodes[a].parent)
        if (nodes[a].points > 0) return a;
    return no_node;
}

// By repeated search over all nodes of all trees.
std::vector<Pick> brute_force(const Scene& scene, const DetailLimits& limits)
{
    std::vector<Pick> wanted;
    std::set<Pick> taken;
    std::uint64_t points = 0;
    std::vector<Frustum> frusta;
    for (const TreeInView& tree : scene.in_view) frusta.push_back(*Frustum::of(tree.view));
    for (;;) {
        Pick best{0, no_node};
        double best_rank = -std::numeric_limits<double>::infinity();
        for (std::uint32_t t = 0; t < scene.trees.size(); ++t) {
            const auto& nodes = scene.trees[t].nodes;
            for (NodeId id = 0; id < nodes.size(); ++id) {
                if (taken.count({t, id}) || (id && !taken.count({t, nodes[id].parent}))) continue;
                const Box3d box = scene.trees[t].grid.to_source(nodes[id].box);
                if (!frusta[t].intersects(box)) continue;
                const double error = ancestor_of(nodes, id) == no_node
                                         ? std::numeric_limits<double>::infinity()
                                         : frusta[t].pixels(nodes[nodes[id].parent].spacing, box);
                const double felt =
                    error *
                    (limits.kept && (nodes[id].points == 0 || limits.kept(t, id)) ? DetailLimits::kept_gain : 1.0);
                if (!(felt > limits.target_px)) continue;
                const double rank = limits.order == DetailOrder::error ? felt : -static_cast<double>(nodes[id].depth);
                if (rank > best_rank) {
                    best = {t, id};
                    best_rank = rank;
                }
            }
        }
        if (best.second == no_node) break;
        const std::uint32_t n = scene.trees[best.first].nodes[best.second].points;
        if (n > 0 && points + n > limits.point_budget) break;
        points += n;
        taken.insert(best);
        if (n > 0) wanted.push_back(best);
    }
    return wanted;
}

std::vector<Pick> picks_of(const SceneSelection& scene)
{
    std::vector<Pick> picks;
    for (const SceneSelection::Place& place : scene.order)
        picks.emplace_back(place.tree, scene.trees[place.tree].wanted[place.index].node);
    return picks;
}

}  // namespace

TEST(SelectScene, TakesTheWorstOfAllTreesFirst)
{
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    std::size_t limited = 0, mixed = 0;
    for (int i = 0; i < 300; ++i) {
        const Scene scene = random_scene(random);
        DetailLimits limits;
        limits.target_px = i % 5 == 0 ? 0 : std::pow(10.0, 3 * unit(random) - 1);
        limits.point_budget = i % 3 == 0 ? random() % 200000 : 1'000'000'000;
        limits.order = i % 7 == 0 ? DetailOrder::depth : DetailOrder::error;
        if (i % 2) limits.kept = [](std::uint32_t tree, NodeId node) { return (tree + node) % 3 == 0; };
        const SceneSelection selection = select_scene(scene.in_view, limits);
        const std::vector<Pick> picks = picks_of(selection);
        ASSERT_EQ(picks, brute_force(scene, limits)) << "case " << i;
        limited += selection.budget_reached;
        std::set<std::uint32_t> trees;
        std::uint64_t points = 0;
        for (const Pick& pick : picks) trees.insert(pick.first);
        for (const DetailSelection& tree : selection.trees) points += tree.wanted_points;
        mixed += trees.size() > 1;
        EXPECT_LE(points, limits.point_budget);
    }
    EXPECT_GT(limited, 20u);
    EXPECT_GT(mixed, 100u);
}

// The selection under a budget is a prefix of the selection without one, so a picture can be continued.
TEST(SelectScene, ABudgetGivesAPrefix)
{
    std::mt19937_64 random(12);
    std::size_t shorter = 0;
    for (int i = 0; i < 300; ++i) {
        const Scene scene = random_scene(random);
        DetailLimits limits;
        limits.target_px = 3;
        limits.point_budget = random() % 300000;
        limits.page_budget = random() % 100;
        DetailLimits everything;
        everything.target_px = 0;
        everything.point_budget = everything.page_budget = ~std::uint64_t(0);
        const std::vector<Pick> some = picks_of(select_scene(scene.in_view, limits));
        const std::vector<Pick> all = picks_of(select_scene(scene.in_view, everything));
        ASSERT_LE(some.size(), all.size());
        EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin())) << "case " << i;
        shorter += some.size() < all.size();
    }
    EXPECT_GT(shorter, 50u);
}

// A trembling camera, in which errors keep crossing the target, draws the same nodes all the time.
TEST(SelectScene, TremblingErrorsChangeNothing)
{
    std::mt19937_64 random(13);
    std::size_t changes_without = 0, changes_with = 0;
    for (int i = 0; i < 100; ++i) {
        const SyntheticTree tree = random_tree(random, 200, {0, 0, 0});
        const Camera view = random_view(random, {100, 75, 120}, {0, 0, 0}, 100);
        for (const bool hysteresis : {false, true}) {
            std::set<Pick> before;
            for (int frame = 0; frame < 8; ++frame) {
                DetailLimits limits;
                limits.target_px = frame % 2 ? 2 * 1.1 : 2 / 1.1;  // as if all errors were smaller, or larger
                limits.point_budget = ~std::uint64_t(0);
                if (hysteresis)
                    limits.kept = [&](std::uint32_t t, NodeId node) { return before.count({t, node}) != 0; };
                const auto picks = picks_of(select_scene({{&tree.nodes, &tree.grid, view}}, limits));
                const std::set<Pick> now(picks.begin(), picks.end());
                if (frame > 0 && now != before) ++(hysteresis ? changes_with : changes_without);
                before = now;
            }
        }
    }
    EXPECT_GT(changes_without, 50u);
    EXPECT_EQ(changes_with, 0u);
}
