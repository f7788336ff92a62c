// How many points of a selection are in view, and the floor under it.
#include "pcm/view/seen_points.h"
#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr std::uint32_t chunk = 1000;

// Nodes of 1000 points, one below the other, each box half as large as the one above, towards the origin: what is near
// the eye in a large cloud.
NodeTable chain(int depth)
{
    std::vector<Node> nodes(static_cast<std::size_t>(depth));
    for (std::size_t d = 0; d < nodes.size(); ++d) {
        Node& node = nodes[d];
        const auto side = static_cast<std::int32_t>(1 << 20) >> d;
        node.depth = static_cast<std::uint16_t>(d);
        node.parent = d == 0 ? no_node : static_cast<NodeId>(d - 1);
        if (d + 1 < nodes.size()) node.children[0] = static_cast<NodeId>(d + 1);
        node.points = chunk;
        node.subtree_points = chunk * (nodes.size() - d);
        node.box = {{0, 0, 0}, {side, side, side}};
        node.spacing = 0.001 * side;
    }
    return NodeTable(std::move(nodes));
}

// Sees the cube from 0 to `side` source units, and nothing else.
Camera view_of_corner(double side)
{
    Camera view;
    view.width = view.height = 1000;
    view.modelview = translation({-side / 2, -side / 2, -side / 2});
    view.projection = orthographic(side / 2, side / 2, -side / 2, side / 2);
    return view;
}

}  // namespace

TEST(SeenPoints, AreThoseOfTheBoxesInView)
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    int partly = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const SyntheticTree tree = random_tree(random, 2 + random() % 40, {0, 0, 0});
        const Vec3d eye{100 * unit(random), 100 * unit(random), 100 * unit(random)};
        const TreeInView in_view{&tree.nodes, &tree.grid, random_view(random, eye, {0, 0, 0}, 100)};
        if (!Frustum::of(in_view.view)) continue;
        DetailLimits everything;
        everything.target_px = -1;
        everything.point_budget = everything.page_budget = ~std::uint64_t(0);
        const SceneSelection selection = select_scene({in_view}, everything);
        const Frustum frustum = *Frustum::of(in_view.view);
        double expected = 0, most_wrong = 0;
        for (const DetailNode& wanted : selection.trees[0].wanted) {
            const Node& node = tree.nodes[wanted.node];
            const Box3d box = tree.grid.to_source(node.box);
            int seen = 0;
            constexpr int samples = 500;
            for (int i = 0; i < samples; ++i) {
                Vec3d p{};
                for (std::size_t a = 0; a < 3; ++a) p[a] = box.min[a] + unit(random) * (box.max[a] - box.min[a]);
                seen += is_visible(clip(in_view.view, p));
            }
            expected += node.points * double(seen) / samples;
            // The estimate divides a box into quarters along each axis.
            if (!frustum.intersects(box) || frustum.contains(box)) continue;
            most_wrong += 0.4 * node.points;
            ++partly;
        }
        EXPECT_NEAR(seen_points({in_view}, selection, 1e18), expected, most_wrong + 1e-6 * expected) << trial;
    }
    EXPECT_GT(partly, 100);
}

TEST(SeenPoints, OfClipsOnlyWhatTheyLeave)
{
    const NodeTable nodes = chain(1);
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    const double side = 0.001 * (1 << 20);
    const std::vector<Clip> clips{
        {Region::oriented_box({0, 0, 0}, {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}, {side / 2, 2e6, 2e6}),
         false}};
    TreeInView in_view{&nodes, &grid, view_of_corner(2 * side)};
    DetailLimits limits;
    const SceneSelection all = select_scene({in_view}, limits);
    ASSERT_EQ(all.order.size(), 1u);
    EXPECT_EQ(seen_points({in_view}, all, 1e18), chunk);
    in_view.clips = &clips;
    EXPECT_EQ(seen_points({in_view}, all, 1e18), chunk / 2);
}

TEST(SeenPoints, ABudgetThatShowsHardlyAnythingIsRaised)
{
    const NodeTable nodes = chain(20);
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    // The boxes of the nodes 10 to 19 are inside.
    const std::vector<TreeInView> trees{{&nodes, &grid, view_of_corner(1.03)}};
    DetailLimits limits;
    limits.target_px = 0;
    limits.point_budget = 2 * chunk;
    const SceneSelection few = select_scene(trees, limits);
    EXPECT_EQ(seen_points(trees, few, 1e18), 0);

    DetailLimits raised = limits;
    const SceneSelection enough = select_scene_seen(trees, raised, 3 * chunk, 1'000'000);
    EXPECT_GE(seen_points(trees, enough, 1e18), 3 * chunk);
    EXPECT_LE(raised.point_budget, 32u * chunk);

    // Not above what is allowed, and not where there is no more, or enough.
    raised = limits;
    EXPECT_EQ(select_scene_seen(trees, raised, 3 * chunk, 5 * chunk).order.size(), 5u);
    EXPECT_EQ(raised.point_budget, 5u * chunk);
    raised = limits;
    EXPECT_EQ(select_scene_seen(trees, raised, 1e9, ~std::uint64_t(0)).order.size(), 20u);
    raised = limits;
    raised.point_budget = 15 * chunk;
    EXPECT_EQ(select_scene_seen(trees, raised, 3 * chunk, 1'000'000).order.size(), 15u);
    EXPECT_EQ(raised.point_budget, 15u * chunk);
    // Video memory is a limit that stays.
    raised = limits;
    raised.page_points = chunk;
    raised.page_budget = 4;
    EXPECT_EQ(select_scene_seen(trees, raised, 3 * chunk, 1'000'000).order.size(), 4u);
}
