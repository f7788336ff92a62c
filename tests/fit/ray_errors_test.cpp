// The bias of fits to points whose errors lie along rays, against the truth and against fits to many such points.
#include "pcm/fit/ray_errors.h"

#include "pcm/fit/shape_fit.h"
#include "tests/place/shape_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.0015;
constexpr Vec3d map{456780, 5432100, 120};

pcm::Shape thin_pipe(double radius)
{
    pcm::Shape pipe;
    pipe.kind = ShapeKind::cylinder;
    pipe.point = map;
    pipe.axis = normalised({0.2, -0.1, 1});
    pipe.radius = radius;
    return pipe;
}

// What a station sees in direction `ray`; errors along that, or along the normal.
void see(const pcm::Shape& pipe, const Vec3d& ray, std::uint32_t station, bool along_ray, int count, Dice& dice,
         std::vector<PointOfStation>& points)
{
    for (int seen = 0; seen < count;) {
        const SurfacePoint p = point_on(pipe, 1, 2 * pi, 0, dice);
        const double cosine = -dot(p.normal, ray);
        if (dice.unit() > cosine || cosine < 0.17) continue;
        points.push_back({p.position + sigma * dice.normal() * (along_ray ? ray : p.normal), station});
        ++seen;
    }
}

pcm::Shape fitted(const pcm::Shape& near, const std::vector<PointOfStation>& points)
{
    std::vector<Vec3d> places;
    for (const PointOfStation& p : points) places.push_back(p.place);
    const ShapeFit fit = refine_shape(FitPoints::of(places), near, {});
    EXPECT_TRUE(fit.has_shape());
    return fit.shape;
}

TEST(RayErrors, AThinPipeSeenFromOneSideIsAsThickAsItIs)
{
    for (const double radius : {0.012, 0.02, 0.05}) {
        const pcm::Shape pipe = thin_pipe(radius);
        const auto [u, v] = across(pipe.axis);
        Dice dice(3);
        std::vector<PointOfStation> points;
        see(pipe, -1 * u, 0, true, 20000, dice, points);
        const pcm::Shape before = fitted(pipe, points);
        const auto after = without_ray_errors(before, points, map, 1);
        ASSERT_TRUE(after) << radius;
        EXPECT_GT(after->share, 0.7);
        const double bias = sigma * sigma / radius;
        EXPECT_LT(before.radius - radius, -1.5 * bias) << radius;
        EXPECT_LT(std::fabs(after->shape.radius - radius), 0.35 * (radius - before.radius)) << radius;
        EXPECT_LT(std::fabs(dot(after->shape.point - map, u)), 0.35 * std::fabs(dot(before.point - map, u))) << radius;
    }
}

TEST(RayErrors, EachStationHasItsRays)
{
    const pcm::Shape pipe = thin_pipe(0.015);
    const auto [u, v] = across(pipe.axis);
    Dice dice(5);
    std::vector<PointOfStation> points;
    see(pipe, -1 * u, 4, true, 12000, dice, points);
    see(pipe, normalised(-0.5 * u - v), 9, true, 12000, dice, points);
    for (PointOfStation& p : points)  // a registration error of its own is not taken for noise
        if (p.station == 9) p.place = p.place + 0.001 * pipe.axis;
    const pcm::Shape before = fitted(pipe, points);
    const auto after = without_ray_errors(before, points, map, 1);
    ASSERT_TRUE(after);
    EXPECT_LT(std::fabs(after->shape.radius - 0.015), 0.5 * std::fabs(before.radius - 0.015));
    const auto off = [&](const pcm::Shape& shape) {
        const Vec3d d = shape.point - map;
        return length(d - dot(d, pipe.axis) * pipe.axis);
    };
    EXPECT_LT(off(after->shape), 0.5 * off(before));
}

TEST(RayErrors, ErrorsAlongTheNormalsHaveNone)
{
    const pcm::Shape pipe = thin_pipe(0.015);
    const auto [u, v] = across(pipe.axis);
    for (int seed = 0; seed < 5; ++seed) {
        Dice dice(static_cast<std::uint64_t>(seed));
        std::vector<PointOfStation> points;
        see(pipe, -1 * u, 0, false, 4000, dice, points);
        const pcm::Shape before = fitted(pipe, points);
        if (const auto after = without_ray_errors(before, points, map, 1)) {
            EXPECT_LT(after->share, 0.15);
            EXPECT_LT(std::fabs(after->shape.radius - before.radius), 5e-5);
        }
    }
}

TEST(RayErrors, PlanesAndPointsAllAroundHaveNone)
{
    Dice dice(7);
    pcm::Shape plane;
    plane.point = map;
    plane.axis = {0, 0, 1};
    std::vector<PointOfStation> points;
    for (int i = 0; i < 500; ++i) points.push_back({point_on(plane, 1, 0, sigma, dice).position, 0});
    EXPECT_FALSE(without_ray_errors(plane, points, map, 1));
    EXPECT_FALSE(without_ray_errors(thin_pipe(0.1), {}, map, 1));
    points.clear();
    for (int i = 0; i < 500; ++i) points.push_back({point_on(thin_pipe(0.1), 1, 2 * pi, sigma, dice).position, 0});
    EXPECT_FALSE(without_ray_errors(thin_pipe(0.1), points, map, 1));
}

}  // namespace
