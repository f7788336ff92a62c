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
constexpr double widest = 0.002;  // standard deviation of a beam's light of which nothing is known
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
        const auto after = without_ray_errors(before, points, map, 1, widest);
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
    const auto after = without_ray_errors(before, points, map, 1, widest);
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
        if (const auto after = without_ray_errors(before, points, map, 1, widest)) {
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
    EXPECT_FALSE(without_ray_errors(plane, points, map, 1, widest));
    EXPECT_FALSE(without_ray_errors(thin_pipe(0.1), {}, map, 1, widest));
    points.clear();
    for (int i = 0; i < 500; ++i) points.push_back({point_on(thin_pipe(0.1), 1, 2 * pi, sigma, dice).position, 0});
    EXPECT_FALSE(without_ray_errors(thin_pipe(0.1), points, map, 1, widest));
}

// Mean distance along the ray of what a beam of four rays lights up, as a scanner measures it.
void light_up(const pcm::Shape& pipe, const Vec3d& ray, double width, std::uint32_t station, int count, Dice& dice,
              std::vector<PointOfStation>& points)
{
    const auto [u, v] = across(ray);
    const auto depth = [&](const Vec3d& from) {  // along the ray, by Newton's steps
        double t = 0;
        for (int step = 0; step < 20; ++step)
            t -= signed_distance(pipe, from + t * ray) / dot(normal_at(pipe, from + t * ray), ray);
        return t;
    };
    for (int seen = 0; seen < count;) {
        const SurfacePoint p = point_on(pipe, 1, 2 * pi, 0, dice);
        const double cosine = -dot(p.normal, ray);
        if (dice.unit() > cosine || cosine < 0.45) continue;  // all of the beam hits the pipe
        double mean = 0;
        for (const Vec3d& side : {u, -1 * u, v, -1 * v}) mean += depth(p.position + std::sqrt(2.0) * width * side) / 4;
        points.push_back({p.position + (mean + 0.0007 * dice.normal()) * ray, station});
        ++seen;
    }
}

// The beam's light is behind the front of a pipe, and farther behind its sides.
TEST(RayErrors, TheWidthOfTheBeamIsSeenAndLeavesThePipe)
{
    constexpr double radius = 0.025;
    const pcm::Shape pipe = thin_pipe(radius);
    const auto [u, v] = across(pipe.axis);
    for (const double width : {0.0, 0.001, 0.0015}) {
        Dice dice(7);
        std::vector<PointOfStation> points;
        light_up(pipe, -1 * u, width, 1, 24000, dice, points);
        const pcm::Shape before = fitted(pipe, points);
        const auto after = without_ray_errors(before, points, map, 1, widest);
        ASSERT_TRUE(after) << width;
        EXPECT_NEAR(after->beam, width, width > 0 ? 0.4 * width : 0.0008);
        const double error = std::fabs(after->shape.radius - after->of_wider_beam.radius);
        EXPECT_GT(error, 0) << width;
        EXPECT_LT(std::fabs(after->shape.radius - radius), 3 * std::hypot(error, 1e-5)) << width;
        if (width > 0)
            EXPECT_LT(std::fabs(after->shape.radius - radius), 0.5 * std::fabs(before.radius - radius)) << width;
    }
}

// A large pipe does not show the beam, and is left as it is.
TEST(RayErrors, ABeamThatNobodySeesIsAsWideAsThoseOfScanners)
{
    const pcm::Shape pipe = thin_pipe(1.5);
    const auto [u, v] = across(pipe.axis);
    Dice dice(9);
    std::vector<PointOfStation> points;
    see(pipe, -1 * u, 0, true, 4000, dice, points);
    const pcm::Shape before = fitted(pipe, points);
    const auto after = without_ray_errors(before, points, map, 3, widest);
    ASSERT_TRUE(after);
    EXPECT_LT(after->beam, 2 * widest);
    EXPECT_LT(std::fabs(after->shape.radius - before.radius), 1e-5);
    EXPECT_LT(std::fabs(after->of_wider_beam.radius - after->shape.radius), 1e-5);
}

}  // namespace
