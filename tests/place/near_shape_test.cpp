// The points near a surface, by scans of a tree and by growth, against a test of every point.

#include "pcm/place/near_shape.h"

#include "pcm/place/grow_shape.h"
#include "pcm/select/grow.h"
#include "pcm/system/error.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

Shape random_shape(std::mt19937_64& random, ShapeKind kind, const Vec3d& near, double size)
{
    const auto number = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
    Shape shape;
    shape.kind = kind;
    shape.point = near + size * Vec3d{number(), number(), number()};
    shape.axis = normalised({number(), number(), number() + 1e-9});
    shape.radius = size * (0.1 + std::fabs(number()));
    shape.second = kind == ShapeKind::cone ? 0.1 + 1.3 * std::fabs(number()) : shape.radius * 0.4;
    return shape;
}

constexpr ShapeKind all_kinds[] = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone,
                                   ShapeKind::torus};

// What is called outside or inside is; and boxes that the surface is far from are called outside.
TEST(NearShape, RelationsOfBoxesAreTrueAndDecide)
{
    std::mt19937_64 random(1);
    const auto number = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
    for (const ShapeKind kind : all_kinds) {
        int outside = 0, inside = 0, could_be_outside = 0;
        for (int round = 0; round < 400; ++round) {
            const Vec3d centre = round % 2 ? Vec3d{5e5, 4.8e6, 100} : Vec3d{};
            const Shape shape = random_shape(random, kind, centre, 1);
            const double threshold = round % 5 == 0 ? 2.5 : 0.02 * (1 + std::fabs(number()));
            const NearShape test(shape, threshold, pi, Schema());
            const double size = std::pow(10, number() - 0.7);
            Box3d box;
            box.min = centre + 1.5 * Vec3d{number(), number(), number()};
            box.max = box.min + size * Vec3d{0.1 + std::fabs(number()), 0.1 + std::fabs(number()), 0.01};
            const BoxRelation relation = test.relation(box);
            outside += relation == BoxRelation::outside;
            inside += relation == BoxRelation::inside;
            double least = HUGE_VAL;
            for (int k = 0; k < 1000; ++k) {
                const Vec3d p = box.min + Vec3d{box.extent(0) * (k % 10) / 9, box.extent(1) * (k / 10 % 10) / 9,
                                                box.extent(2) * (k / 100) / 9};
                least = std::min(least, distance_to(shape, p));
                if (relation == BoxRelation::outside) ASSERT_FALSE(test.holds(p));
                if (relation == BoxRelation::inside) ASSERT_TRUE(test.holds(p));
            }
            could_be_outside += least > threshold + 0.1 * size;
        }
        EXPECT_GE(outside, could_be_outside) << traits_of(kind).name;
        EXPECT_GT(could_be_outside, 100);
        EXPECT_GT(inside, 10);
    }
}

TEST(NearShape, WhatIsNoShapeOrNoThresholdIsRefused)
{
    const Shape plane;
    for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) EXPECT_THROW(NearShape(plane, bad, pi, {}), Error);
    for (const double bad : {0.0, -1.0, std::nan("")}) EXPECT_THROW(NearShape(plane, 1, bad, {}), Error);
    Shape none;
    none.axis = {0, 0, 0};
    EXPECT_THROW(NearShape(none, 1, pi, {}), Error);
}

constexpr Vec3d map{500123.4, 4800567.8, 100};

pcm::Shape shape_of(ShapeKind kind)
{
    Shape shape;
    shape.kind = kind;
    shape.point = map;
    shape.axis = normalised({0.3, -0.2, 0.9});
    shape.radius = 1.5;
    shape.second = 0.4;
    return shape;
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(PointsOnShape, PCM_NOT_UNDER_THREAD(AreThoseOfATestOfEachPoint))
{
    for (const ShapeKind kind : all_kinds) {
        TemporaryFolder folder;
        Dice dice(7);
        const Shape shape = shape_of(kind);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 12000; ++i) points.push_back(point_on(shape, 4, 2 * pi, 0.02, dice));
        for (int i = 0; i < 12000; ++i) points.push_back({map + dice.between(0, 6) * dice.direction(), {}});
        const auto tree = build_surface_tree(folder.path(), points);
        Selection half;
        half.box = Box3d{map - Vec3d{9, 9, 9}, map + Vec3d{0.3, 9, 9}};
        for (const double threshold : {0.03, 0.2, 5.0}) {
            const PointSet wanted = set_where(
                tree, [&](const Vec3d& p) { return distance_to(shape, p) <= threshold && half.box->contains(p); });
            ASSERT_GT(wanted.size(), 3000u);
            for (const unsigned threads : {1u, 3u})
                EXPECT_TRUE(points_on_shape(tree, shape, threshold, pi, half, threads) == wanted)
                    << traits_of(kind).name << " " << threshold;
        }
    }
}

// Normals of either sign; points without one are judged by their place.
TEST(PointsOnShape, HaveNormalsLikeTheSurface)
{
    TemporaryFolder folder;
    Dice dice(8);
    const Shape shape = shape_of(ShapeKind::cylinder);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 9000; ++i) {
        points.push_back(point_on(shape, 4, 2 * pi, 0.01, dice));
        Vec3d& n = points.back().normal;
        if (i % 3 == 0) n = -1 * n;
        if (i % 3 == 1) n = normalised(n + 0.9 * shape.axis);  // 42 degrees
        if (i % 300 == 2) n = {0, 0, 0};
    }
    const auto tree = build_surface_tree(folder.path(), points, true);
    EXPECT_EQ(points_on_shape(tree, shape, 0.1, 40 * pi / 180, {}).size(), 6000u);
    EXPECT_EQ(points_on_shape(tree, shape, 0.1, 44 * pi / 180, {}).size(), 9000u);
    EXPECT_EQ(points_on_shape(tree, shape, 0.1, pi, {}).size(), 9000u);
    EXPECT_EQ(points_on_shape(tree, shape, 10, 40 * pi / 180, {}).size(), 6000u);  // nodes inside the shell, too
}

// What is far from the surface is not read.
TEST(PointsOnShape, NodesFarFromTheSurfaceAreNotRead)
{
    TemporaryFolder folder;
    Dice dice(9);
    std::vector<SurfacePoint> points;
    Shape sphere = shape_of(ShapeKind::sphere);
    for (int i = 0; i < 4000; ++i) points.push_back(point_on(sphere, 0, 0, 0.01, dice));
    for (int i = 0; i < 60000; ++i)
        points.push_back({map + Vec3d{20, 0, 0} + dice.between(0, 9) * dice.direction(), {}});
    const auto tree = build_surface_tree(folder.path(), points);
    const NearShape test(sphere, 0.05, pi, tree->info().schema);
    std::uint64_t read = 0;
    std::mutex mutex;
    ScanOptions options;
    options.test = &test;
    options.columns = ColumnSet::only_positions();
    std::uint64_t touched = 0;
    for (NodeId node = 0; node < tree->nodes().size(); ++node)
        touched += test.relation(tree->box(node)) != BoxRelation::outside ? tree->node(node).points : 0;
    scan_points(*tree, {}, options, [&](const ScannedPoints& found) {
        const std::lock_guard lock(mutex);
        read += found.part.chunk.points;
    });
    EXPECT_LT(touched, 12000u);
    EXPECT_LT(read, 12000u);
    EXPECT_GE(read, 4000u);
}

// Growth through points near the surface: not over a gap of the surface, and not through other points.
TEST(GrowNearShape, IsGrowthThroughThePointsNearTheSurface)
{
    TemporaryFolder folder;
    Dice dice(10);
    const Shape pipe = shape_of(ShapeKind::cylinder);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 8000; ++i) {
        const SurfacePoint p = point_on(pipe, 9, 2 * pi, 0.01, dice);
        const double along = dot(p.position - pipe.point, pipe.axis);
        if (along < 5 || along > 6) points.push_back(p);
    }
    for (int i = 0; i < 8000; ++i) points.push_back({map + 9 * dice.unit() * dice.direction(), {}});
    const auto tree = build_surface_tree(folder.path(), points);
    const NearShape test(pipe, 0.05, pi, tree->info().schema);
    PointSet seeds(tree);
    std::vector<PlacedPoint> near;
    for (const PlacedPoint& p : all_points(*tree))
        if (test.holds(p.position)) near.push_back(p);
    const auto seed = std::find_if(near.begin(), near.end(), [&](const PlacedPoint& p) {
        return std::fabs(dot(p.position - pipe.point, pipe.axis) - 2) < 0.1;
    });
    ASSERT_NE(seed, near.end());
    seeds.set(seed->node, {seed->number});
    const double step = 0.4;
    std::vector<bool> reached(near.size(), false);
    std::vector<std::size_t> next{static_cast<std::size_t>(seed - near.begin())};
    reached[next[0]] = true;
    while (!next.empty()) {
        const std::size_t i = next.back();
        next.pop_back();
        for (std::size_t j = 0; j < near.size(); ++j)
            if (!reached[j] && squared_distance(near[i].position, near[j].position) <= step * step) {
                reached[j] = true;
                next.push_back(j);
            }
    }
    PointSet wanted(tree);
    for (std::size_t i = 0; i < near.size(); ++i)
        if (reached[i]) wanted.combine(SetOperation::add, near[i].node, {near[i].number});
    ASSERT_GT(wanted.size(), 3000u);
    ASSERT_LT(wanted.size(), near.size() - 1000);
    for (const std::uint64_t memory : {std::uint64_t(1), std::uint64_t(1) << 30}) {
        GrowOptions options;
        options.test = &test;
        options.memory_bytes = memory;
        options.threads = memory == 1 ? 3 : 1;
        EXPECT_TRUE(grow(seeds, step, options) == wanted);
    }
    // A seed that the test does not choose reaches nothing.
    PointSet off_shape(tree);
    for (const PlacedPoint& p : all_points(*tree))
        if (distance_to(pipe, p.position) > 0.2) {
            off_shape.set(p.node, {p.number});
            break;
        }
    GrowOptions options;
    options.test = &test;
    EXPECT_TRUE(grow(off_shape, step, options).empty());
}

}  // namespace
