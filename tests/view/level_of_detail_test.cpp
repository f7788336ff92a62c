// Node choice against brute force over random trees, and culling and projected sizes against plain projection.
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

NodeId ancestor_with_points(const std::vector<Node>& nodes, NodeId id)
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

TEST(Frustum, NeverDropsABoxWithAVisiblePoint)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    std::size_t visible = 0;
    std::size_t culled = 0;
    for (int i = 0; visible < 10000; ++i) {
        ASSERT_LT(i, 2000000);
        const Vec3d origin = i % 3 == 0 ? Vec3d{0, 0, 0} : Vec3d{500000, 5000000, 100};
        const Vec3d place = i % 3 == 1 ? origin : Vec3d{500000, 5000000, 100};  // far from the local origin at times
        const double reach = std::pow(10.0, 5 * unit(random) - 2);
        const auto near_place = [&](double spread) {
            return Vec3d{place[0] + spread * (unit(random) - 0.5), place[1] + spread * (unit(random) - 0.5),
                         place[2] + spread * (unit(random) - 0.5)};
        };
        const Camera view = random_view(random, near_place(reach), origin, reach);
        const auto frustum = Frustum::of(view);
        ASSERT_TRUE(frustum);
        Vec3d point = near_place(reach);
        auto c = clip(view, point);
        if (i % 2 == 0 && is_visible(c)) {
            // Move towards the border of the clip volume by bisection: the hard cases lie there.
            Vec3d outside = near_place(20 * reach);
            if (!is_visible(clip(view, outside))) {
                for (int step = 0; step < 80; ++step) {
                    Vec3d middle{};
                    for (std::size_t a = 0; a < 3; ++a) middle[a] = point[a] + (outside[a] - point[a]) / 2;
                    (is_visible(clip(view, middle)) ? point : outside) = middle;
                }
                c = clip(view, point);
            }
        }
        Box3d box;
        box.extend(point);
        const int shape = i % 4;  // a point, a line, a flat box, a box; the point in a corner or inside
        for (int a = 0; a < shape; ++a) {
            const double size = reach * std::pow(10.0, -3 * unit(random));
            box.min[a] -= unit(random) < 0.5 ? 0 : size * unit(random);
            box.max[a] += unit(random) < 0.5 ? 0 : size * unit(random);
        }
        if (is_visible(c)) {
            ++visible;
            ASSERT_TRUE(frustum->intersects(box)) << "case " << i;
        } else {
            culled += !frustum->intersects(box);
        }
    }
    EXPECT_GT(culled, 1000u);  // it does cull
}

TEST(Frustum, CullsWhatIsBeyondOnePlane)
{
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    std::size_t outside = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d place{500000, 5000000, 100};
        const Camera view = random_view(random, place, place, 10);
        Box3d box;
        for (int corner = 0; corner < 2; ++corner)
            box.extend(Vec3d{place[0] + 40 * (unit(random) - 0.5), place[1] + 40 * (unit(random) - 0.5),
                             place[2] + 40 * (unit(random) - 0.5)});
        // All eight corners beyond one plane by more than the rounding at map coordinates.
        bool beyond = false;
        for (std::size_t axis = 0; axis < 3 && !beyond; ++axis)
            for (const double sign : {-1.0, 1.0}) {
                bool all = true;
                for (int corner = 0; corner < 8; ++corner) {
                    const auto c =
                        clip(view, {corner & 1 ? box.max[0] : box.min[0], corner & 2 ? box.max[1] : box.min[1],
                                    corner & 4 ? box.max[2] : box.min[2]});
                    all = all && sign * c[axis] > c[3] + 1e-6 * (std::abs(c[axis]) + std::abs(c[3]) + 1);
                }
                beyond = beyond || all;
            }
        if (!beyond) continue;
        ++outside;
        EXPECT_FALSE(Frustum::of(view)->intersects(box)) << "case " << i;
    }
    EXPECT_GT(outside, 1000u);
}

TEST(Frustum, PixelsAreThoseOfAProjectedSegment)
{
    // On the axis, a segment face on at distance d; orthographic anywhere. The projection is the oracle; 1e-6: what is
    // left of a millimetre at coordinates of 5e6 after two projections.
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 2000; ++i) {
        const Vec3d eye{500000, 5000000, 100};
        const Vec3d origin = i % 2 ? eye : Vec3d{0, 0, 0};
        const Matrix4d turn = rotation(random);
        const double scale = std::pow(10.0, 2 * unit(random) - 1);
        Camera view;
        view.origin = origin;
        view.width = 900;
        view.height = 600;
        view.modelview = product(
            turn, product(scaling(scale), translation({origin[0] - eye[0], origin[1] - eye[1], origin[2] - eye[2]})));
        const bool ortho = i % 4 >= 2;
        view.projection = ortho ? orthographic(3, 2, 1e-6, 1000) : perspective(-3e-6, 3e-6, -2e-6, 2e-6, 2e-6, 1e6);
        const double distance = 1 + 50 * unit(random);
        const Vec3d right{turn[0], turn[4], turn[8]};
        const Vec3d back{turn[2], turn[6], turn[10]};
        const double length = 0.5;
        Vec3d a{}, b{};
        for (std::size_t k = 0; k < 3; ++k) {
            a[k] = eye[k] - distance * back[k];
            b[k] = a[k] + length * right[k];
        }
        const auto ca = clip(view, a);
        const auto cb = clip(view, b);
        const double expected = (cb[0] / cb[3] - ca[0] / ca[3]) * view.width / 2;
        Box3d box;
        box.extend(a);
        const auto frustum = Frustum::of(view);
        EXPECT_EQ(frustum->orthographic(), ortho);
        EXPECT_NEAR(frustum->pixels(length, box), expected, 1e-6 * expected);
    }
}

TEST(Frustum, TheEyeInsideABoxGivesAFiniteSizeLimitedByTheNearPlane)
{
    Camera view;
    view.modelview = identity();
    view.projection = perspective(-1e-6, 1e-6, -1e-6, 1e-6, 1e-6, 1);
    view.width = view.height = 1000;
    Box3d box;
    box.extend(Vec3d{-1, -1, -1});
    box.extend(Vec3d{1, 1, 1});
    const auto frustum = Frustum::of(view);
    ASSERT_TRUE(frustum);
    EXPECT_NEAR(frustum->pixels(1e-6, box), 500, 1e-3);  // half the viewport at the near plane
    EXPECT_EQ(frustum->pixels(0, box), 0);
}

TEST(Frustum, RefusesViewsThatShowNothing)
{
    Camera view;
    view.modelview = identity();
    view.projection = orthographic(1, 1, -1, 1);
    view.width = view.height = 10;
    EXPECT_TRUE(Frustum::of(view));
    Camera bad = view;
    bad.width = 0;
    EXPECT_FALSE(Frustum::of(bad));
    bad = view;
    bad.modelview[0] = std::nan("");
    EXPECT_FALSE(Frustum::of(bad));
    bad = view;
    bad.modelview[5] = 0;  // singular
    EXPECT_FALSE(Frustum::of(bad));
    bad = view;
    bad.modelview[3] = 1;  // not affine
    EXPECT_FALSE(Frustum::of(bad));
    bad = view;
    bad.projection[10] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(Frustum::of(bad));
    std::mt19937_64 random(4);
    EXPECT_TRUE(select_detail(random_tree(random, 10, {}).nodes, Grid{}, bad, {}).wanted.empty());
}

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

        // What can be drawn when some chunks are not there yet.
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
        // Leaving empty nodes "beyond" is an error too, which the oracle below does not look for.
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
