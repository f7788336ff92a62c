// An elbow without the straight pipes at its ends, by points whose truth is known.
#include "pcm/place/swept_part.h"

#include "pcm/fit/shape_fit.h"
#include "pcm/place/bent_tube.h"
#include "pcm/place/grow_shape.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.0015, threshold = 0.005;
constexpr Vec3d map{456780, 5432100, 120};

pcm::Shape bend()
{
    pcm::Shape shape;
    shape.kind = ShapeKind::torus;
    shape.point = map;
    shape.axis = normalised({0.1, 0.2, 1});
    shape.radius = 0.457;
    shape.second = 0.162;
    return shape;
}

// A quarter of the torus and, from both of its ends on, straight pipes of this length, all around.
std::vector<SurfacePoint> elbow(double legs, Dice& dice, int density)
{
    const pcm::Shape shape = bend();
    const auto [u, v] = across(shape.axis);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < density; ++i) {
        const double a = dice.between(0, pi / 2), b = dice.between(0, 2 * pi);
        const Vec3d out = std::cos(a) * u + std::sin(a) * v;
        const Vec3d n = std::cos(b) * out + std::sin(b) * shape.axis;
        points.push_back({shape.point + shape.radius * out + (shape.second + sigma * dice.normal()) * n, n});
    }
    const double arc = shape.radius * pi / 2;
    for (int i = 0; i < static_cast<int>(density * legs / arc); ++i)
        for (const int end : {0, 1}) {
            const Vec3d out = end == 0 ? u : v, on = end == 0 ? -1 * v : -1 * u;
            const double b = dice.between(0, 2 * pi);
            const Vec3d n = std::cos(b) * out + std::sin(b) * shape.axis;
            points.push_back({shape.point + shape.radius * out + dice.between(0, legs) * on +
                                  (shape.second + sigma * dice.normal()) * n,
                              n});
        }
    return points;
}

std::vector<Vec3d> near(const pcm::Shape& shape, const std::vector<SurfacePoint>& points, double within = threshold)
{
    std::vector<Vec3d> on;
    for (const SurfacePoint& p : points)
        if (distance_to(shape, p.position) <= within) on.push_back(p.position);
    return on;
}

std::optional<SweptPart> part_of_elbow(const pcm::Shape& shape, const std::vector<SurfacePoint>& points)
{
    return swept_part(shape, threshold, near(shape, points), near(shape, points, around_thresholds * threshold));
}

TEST(SweptPart, AnElbowEndsWhereItsPipesBegin)
{
    Dice dice(3);
    const std::vector<SurfacePoint> all = elbow(0.4, dice, 6000);
    pcm::Shape shape = bend();
    double radius = 0;
    for (int round = 0; round < 4; ++round) {  // least squares of all points within the threshold
        const std::vector<Vec3d> points = near(shape, all);
        RefineOptions options;
        options.threshold = threshold;
        const ShapeFit fit = refine_shape(FitPoints::of(points), shape, options);
        ASSERT_TRUE(fit.has_shape());
        shape = fit.shape;
        radius = fit.shape.radius;
    }
    EXPECT_GT(std::fabs(radius - 0.457), 0.002) << "the pipes turn it";
    const auto part = part_of_elbow(shape, all);
    ASSERT_TRUE(part);
    EXPECT_NEAR(part->shape.radius, 0.457, 0.0012);
    EXPECT_NEAR(part->shape.second, 0.162, 0.0003);
    EXPECT_GT(part->to - part->from, 0.9);
    EXPECT_LT(part->to - part->from, pi / 2 + 0.01);
    const auto [u, v] = across(bend().axis);
    EXPECT_TRUE(part->has(map + 0.5 * normalised(u + v)));
    EXPECT_FALSE(part->has(map + 0.457 * u - 0.1 * v));
    EXPECT_FALSE(part->has(map + 0.457 * v - 0.1 * u));
}

TEST(SweptPart, WithoutPipesNothingIsLeftOut)
{
    int left_out = 0;
    for (int seed = 0; seed < 10; ++seed) {
        Dice dice(seed);
        left_out += part_of_elbow(bend(), elbow(0, dice, 4000)) ? 1 : 0;
    }
    EXPECT_LE(left_out, 1);
}

TEST(SweptPart, OtherKindsAndFewPointsHaveNone)
{
    pcm::Shape plane;
    plane.point = map;
    EXPECT_FALSE(swept_part(plane, threshold, {map, map, map}, {map, map, map}));
    EXPECT_FALSE(swept_part(bend(), threshold, {map, map, map}, {map, map, map}));
}

// What grows of `start` from the points around the middle of an elbow with straight pipes of this length.
GrownShape grown_elbow(const pcm::Shape& start, double straight, std::uint64_t seed, int density = 6000,
                       double step = 0.05)
{
    TemporaryFolder folder;
    Dice dice(seed);
    const auto tree = build_surface_tree(folder.path(), elbow(straight, dice, density));
    GrowShapeOptions options;
    options.threshold = threshold;
    options.step = step;
    const auto [u, v] = across(bend().axis);
    const Vec3d middle = map + 0.457 * normalised(u + v);
    return grow_shape(start, set_where(tree, [&](const Vec3d& p) { return length(p - middle) < 0.25; }), options);
}

// The whole way: the elbow's radius is within three of its standard deviations, and growth says which part it is of.
TEST(SweptPart, GrowthFitsTheElbowAlone)
{
    const GrownShape grown = grown_elbow(bend(), 0.4, 5);
    ASSERT_TRUE(grown.fit.has_shape());
    ASSERT_TRUE(grown.part);
    EXPECT_LT(std::fabs(grown.fit.shape.radius - 0.457), 3 * grown.fit.errors.radius);
    EXPECT_LT(std::fabs(grown.fit.shape.second - 0.162), 3 * grown.fit.errors.second);
    EXPECT_LT(length(grown.fit.shape.point - map), 3 * grown.fit.errors.position);
}

// Points that were picked with a shape that the pipes had turned make it too wide, by more than its errors.
TEST(SweptPart, TheElbowHasSettled)
{
    double sum = 0;
    constexpr int seeds = 6;
    for (int seed = 0; seed < seeds; ++seed) {
        const auto [u, v] = across(bend().axis);
        pcm::Shape wide = bend();
        wide.radius = 0.47;
        wide.point = map - 0.013 * normalised(u + v);
        const GrownShape grown = grown_elbow(wide, 0.5, static_cast<std::uint64_t>(20 + seed));
        ASSERT_TRUE(grown.part) << seed;
        sum += (grown.fit.shape.radius - 0.457) / grown.fit.errors.radius;
    }
    EXPECT_LT(std::fabs(sum / seeds), 3 / std::sqrt(double(seeds)));
}

// Few points on the torus do not show where the pipes leave it; those that have left it do.
TEST(SweptPart, AnElbowOfFewPointsEndsThereToo)
{
    const auto [u, v] = across(bend().axis);
    pcm::Shape wide = bend();
    wide.radius = 0.49;
    wide.point = map - 0.03 * normalised(u + v);
    double squares = 0;
    constexpr int seeds = 8;
    for (int seed = 0; seed < seeds; ++seed) {
        const GrownShape grown = grown_elbow(wide, 0.5, static_cast<std::uint64_t>(40 + seed), 150, 0.2);
        ASSERT_TRUE(grown.part) << seed;
        const double off = (grown.fit.shape.radius - 0.457) / grown.fit.errors.radius;
        EXPECT_LT(std::fabs(off), 4) << seed;
        squares += off * off / seeds;
    }
    EXPECT_LT(squares, 2.5);
}

// A second elbow next to it, to the same side: one wide bend lies along both. From the ends of the first one alone its
// own are found again.
TEST(SweptPart, TheEndsThatWereFoundAreFoundAgain)
{
    Dice dice(8);
    std::vector<SurfacePoint> all = elbow(0.06, dice, 1500);
    const auto [u, v] = across(bend().axis);
    const std::size_t own = all.size();
    for (std::size_t i = 0; i < own; ++i) {  // mirrored at the middle of the pipe between them
        const Vec3d d = all[i].position - map;
        const double x = dot(d, u), y = dot(d, v), h = dot(d, bend().axis);
        all.push_back({map + x * u + (-0.12 - y) * v + h * bend().axis, {}});
    }
    SweptPart before;
    before.start = normalised(-1 * u - v);
    before.from = angle_about(bend(), before.start, map + u);
    before.to = angle_about(bend(), before.start, map + v);
    const std::vector<Vec3d> on = near(bend(), all), around = near(bend(), all, around_thresholds * threshold);
    const auto part = swept_part(bend(), threshold, on, around, &before);
    ASSERT_TRUE(part);
    EXPECT_NEAR(part->shape.radius, 0.457, 0.004);
    EXPECT_NEAR(part->from, before.from, 0.1);
    EXPECT_GT(dot(part->start, before.start), 0.999) << "angles are counted as before";
}

}  // namespace
