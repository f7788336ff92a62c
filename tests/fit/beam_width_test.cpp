// The width of a scanner's beam, by points whose places behind a curved surface are computed by its second derivatives.
#include "pcm/fit/beam_width.h"

#include "tests/place/shape_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double width = 0.0015, wide = 1;  // standard deviations of the light; `wide` leaves all to the points
constexpr double radius = 0.025, step = 2e-5;

pcm::Shape curved(ShapeKind kind)
{
    pcm::Shape shape;
    shape.kind = kind;
    shape.axis = normalised({0.2, -0.1, 1});
    shape.radius = radius;
    return shape;
}

// The factor of the light's variance: -(q1' H q1 + q2' H q2) / 2 at a place with this normal, seen along `ray`.
double behind(const pcm::Shape& shape, const Vec3d& normal, const Vec3d& ray)
{
    double sum = 0;
    const auto [first, second] = across(ray);
    for (const Vec3d& side : {first, second}) {
        const Vec3d q = side - (dot(normal, side) / dot(normal, ray)) * ray;
        const double bend =
            shape.kind == ShapeKind::sphere ? dot(q, q) : std::pow(dot(q, cross(shape.axis, normal)), 2);
        sum += bend / shape.radius;
    }
    return -sum / 2;
}

// Points that `ray` (towards the station) sees at more than this cosine, with errors along the ray and the normals.
StationRays seen(const pcm::Shape& shape, const Vec3d& ray, double beam, double along, double noise, int count,
                 Dice& dice, double least_cosine = 0.45)
{
    StationRays rays;
    rays.direction = ray;
    rays.noise = along * along;
    while (static_cast<int>(rays.points.size()) < count) {
        const SurfacePoint p = point_on(shape, 0.5, 2 * pi, 0, dice);
        if (dot(p.normal, ray) < least_cosine) continue;
        const double off = beam * beam * behind(shape, p.normal, ray) + noise * dice.normal();
        rays.points.push_back({p.position + off * p.normal + along * dice.normal() * ray, p.normal, off});
    }
    return rays;
}

BeamWidth width_of(const pcm::Shape& shape, const std::map<std::uint32_t, StationRays>& stations, double widest = wide)
{
    const ShapeModel& model = model_of(shape.kind);
    return beam_width(model, model.patch_at(shape, {}), stations, widest, step);
}

const Vec3d towards = normalised({1, 0.3, -0.2});

TEST(BeamWidth, IsThatOfThePointsBehindPipesAndBalls)
{
    for (const ShapeKind kind : {ShapeKind::cylinder, ShapeKind::sphere})
        for (const double beam : {0.0008, width}) {
            Dice dice(2);
            const BeamWidth found =
                width_of(curved(kind), {{4, seen(curved(kind), towards, beam, 0, 2e-6, 4000, dice)}});
            EXPECT_NEAR(std::sqrt(found.variance), beam, 0.02 * beam) << int(kind);
        }
}

// A registration shifts each station as a whole, which bends distances, too.
TEST(BeamWidth, ShiftsOfStationsAreNoWidth)
{
    Dice dice(3);
    const pcm::Shape pipe = curved(ShapeKind::cylinder);
    std::map<std::uint32_t, StationRays> stations;
    for (const std::uint32_t station : {2u, 7u}) {
        const Vec3d ray = station == 2 ? towards : normalised({-0.4, 1, 0.1});
        const Vec3d shift = station == 2 ? Vec3d{0.0003, -0.0002, 0.0001} : Vec3d{-0.0001, 0.0002, 0.0003};
        stations[station] = seen(pipe, ray, width, 0, 2e-6, 3000, dice);
        for (PointOnShape& p : stations[station].points) p.place = p.place + shift;
    }
    EXPECT_NEAR(std::sqrt(width_of(pipe, stations).variance), width, 0.05 * width);
}

// Rays that graze the surface light up what is next to the shape.
TEST(BeamWidth, PointsThatRaysGrazeAreLeftOut)
{
    Dice dice(5);
    const pcm::Shape pipe = curved(ShapeKind::cylinder);
    StationRays rays = seen(pipe, towards, width, 0, 1e-4, 2000, dice);
    const BeamWidth before = width_of(pipe, {{1, rays}});
    const StationRays all = seen(pipe, towards, 0, 0, 0.002, 4000, dice, 0);
    for (const PointOnShape& p : all.points)
        if (dot(p.normal, towards) < 0.39) rays.points.push_back(p);
    ASSERT_GT(rays.points.size(), 2500u);
    const BeamWidth after = width_of(pipe, {{1, rays}});
    EXPECT_EQ(after.variance, before.variance);
    EXPECT_EQ(after.error, before.error);
    EXPECT_EQ(after.pulls, before.pulls);
}

TEST(BeamWidth, PullsAreThoseOfTheWholeLight)
{
    Dice dice(6);
    const pcm::Shape pipe = curved(ShapeKind::cylinder);
    const StationRays rays = seen(pipe, towards, 0, 0, 1e-5, 1000, dice);
    const ShapeModel& model = model_of(pipe.kind);
    const SurfacePatch patch = model.patch_at(pipe, {});
    std::array<double, most_parameters> expected{};
    for (const PointOnShape& p : rays.points) {
        PatchBlock block;
        model.differentiate(patch, &p.place[0], &p.place[1], &p.place[2], 1, block);
        for (std::size_t j = 0; j < model.parameters(); ++j)
            expected[j] += block.by[j][0] * behind(pipe, p.normal, towards);
    }
    const BeamWidth found = width_of(pipe, {{1, rays}});
    double largest = 0;
    for (const double pull : expected) largest = std::max(largest, std::fabs(pull));
    for (std::size_t j = 0; j < most_parameters; ++j) EXPECT_NEAR(found.pulls[j], expected[j], 0.005 * largest) << j;
}

// Errors along the rays bend a thin pipe's distances, too: about as much as half of such a beam.
TEST(BeamWidth, ErrorsAlongTheRaysAreNoWidthAndItsErrorIsHonest)
{
    const pcm::Shape pipe = curved(ShapeKind::cylinder);
    double sum = 0, squares = 0;
    constexpr int seeds = 60;
    for (int seed = 0; seed < seeds; ++seed) {
        Dice dice(static_cast<std::uint64_t>(100 + seed));
        const BeamWidth found = width_of(pipe, {{1, seen(pipe, towards, width, 0.0015, 0, 12000, dice)}});
        ASSERT_GT(found.error, 0);
        const double z = (found.variance - width * width) / found.error;
        sum += z / seeds;
        squares += z * z / seeds;
    }
    EXPECT_LT(std::fabs(sum), 3.5 / std::sqrt(seeds));
    EXPECT_GT(std::sqrt(squares), 0.7);
    EXPECT_LT(std::sqrt(squares), 1.4);
}

// Its error is that of what the equations leave, which a shift of the station is not part of.
TEST(BeamWidth, ShiftsOfStationsAreNoError)
{
    pcm::Shape pipe = curved(ShapeKind::cylinder);
    pipe.radius = 0.25;
    double errors[2];
    for (const int shifted : {0, 1}) {
        Dice dice(7);
        StationRays rays = seen(pipe, towards, 0, 0, 0.0001, 3000, dice);
        for (PointOnShape& p : rays.points) p.place = p.place + shifted * 0.0008 * towards;
        errors[shifted] = width_of(pipe, {{1, rays}}).error;
    }
    EXPECT_NEAR(errors[1], errors[0], 0.05 * errors[0]);
}

TEST(BeamWidth, WithoutEvidenceItIsThatOfScanners)
{
    pcm::Shape tank = curved(ShapeKind::cylinder);
    tank.radius = 20;
    Dice dice(8);
    constexpr double widest = 0.002;
    const BeamWidth found = width_of(tank, {{1, seen(tank, towards, 0, 0, 0.0015, 500, dice)}}, widest);
    EXPECT_NEAR(found.error, widest * widest, 0.1 * widest * widest);
    EXPECT_LT(found.variance, 0.3 * widest * widest);
}

TEST(StationRays, AreTheMeanNormalsOfStationsThatShowThem)
{
    const pcm::Shape pipe = curved(ShapeKind::cylinder);
    Dice dice(9);
    const Vec3d middle{10, 20, 30};
    pcm::Shape moved = pipe;
    moved.point = pipe.point + middle;
    std::vector<PointOfStation> points;
    for (const PointOnShape& p : seen(pipe, towards, 0, 0, 0.001, 400, dice).points)
        points.push_back({middle + p.place, 3});
    for (const PointOnShape& p : seen(pipe, -1 * towards, 0, 0, 0.001, 24, dice).points)
        points.push_back({middle + p.place, 5});
    for (const PointOnShape& p : seen(pipe, towards, 0, 0, 0.001, 23, dice).points)
        points.push_back({middle + p.place, 6});  // too few
    for (const double way : {-1.0, 1.0})          // all around
        for (const PointOnShape& p : seen(pipe, way * towards, 0, 0, 0.001, 200, dice).points)
            points.push_back({middle + p.place, 8});
    constexpr double extent = 2;
    const auto stations = rays_of(moved, points, middle, extent);
    ASSERT_EQ(stations.size(), 2u);
    for (const auto& [station, sign] : {std::pair(3u, 1.0), std::pair(5u, -1.0)}) {
        const StationRays& rays = stations.at(station);
        EXPECT_NEAR(length(rays.direction), 1, 1e-12);
        // What points see of a pipe is across it.
        const Vec3d seen_across = normalised(towards - dot(towards, pipe.axis) * pipe.axis);
        EXPECT_GT(sign * dot(rays.direction, seen_across), station == 3 ? 0.995 : 0.95);
        EXPECT_EQ(rays.noise, 0);
    }
    const PointOnShape& first = stations.at(3).points.front();
    EXPECT_NEAR(length(first.place - (1 / extent) * (points.front().place - middle)), 0, 1e-15);
    EXPECT_NEAR(first.distance, signed_distance(moved, points.front().place) / extent, 1e-15);
    EXPECT_EQ(stations.at(3).points.size(), 400u);
}

}  // namespace
