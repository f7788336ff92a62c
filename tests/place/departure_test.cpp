// Ovals, bulges and dents leave a smooth surface near the shape; noise and errors of a scanner do not.
#include "pcm/place/departure.h"

#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.0015, threshold = 0.02;
constexpr Vec3d map{456780, 5432100, 120};

pcm::Shape of_kind(ShapeKind kind)
{
    pcm::Shape shape;
    shape.kind = kind;
    shape.point = map;
    shape.axis = normalised({0.3, -0.2, 1});
    shape.radius = kind == ShapeKind::torus ? 0.8 : 0.285;
    shape.second = kind == ShapeKind::torus ? 0.2 : 0.4;
    return shape;
}

std::vector<Vec3d> points_of(const pcm::Shape& shape, double noise, std::uint64_t seed)
{
    Dice dice(seed);
    std::vector<Vec3d> points;
    for (int i = 0; i < 3000; ++i) points.push_back(point_on(shape, 1.2, 1.3 * pi, noise, dice).position);
    return points;
}

TEST(DepartureOf, OfNoiseThereIsNone)
{
    for (const ShapeKind kind :
         {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone, ShapeKind::torus})
        for (const std::uint64_t seed : {1u, 2u, 3u}) {
            const Departure departure = departure_of(of_kind(kind), threshold, points_of(of_kind(kind), sigma, seed));
            EXPECT_LT(departure.share, 0.05) << traits_of(kind).name;
            EXPECT_NEAR(departure.rest, sigma, 0.1 * sigma) << traits_of(kind).name;
            EXPECT_FALSE(departure.is_smooth(sigma)) << traits_of(kind).name;
        }
    EXPECT_TRUE(departure_of(of_kind(ShapeKind::plane), threshold, {}).is_chance);
    EXPECT_TRUE(departure_of(of_kind(ShapeKind::plane), threshold, std::vector<Vec3d>(500, map)).is_chance);
}

// 600 x 540 mm as a pipe of 570 mm: 15 mm at both diameters, 10.6 in the mean.
TEST(DepartureOf, AnOvalHasItsSize)
{
    const pcm::Shape pipe = of_kind(ShapeKind::cylinder);
    const auto [u, v] = across(pipe.axis);
    Dice dice(4);
    std::vector<Vec3d> points;
    for (int i = 0; i < 3000; ++i) {
        const double a = dice.between(0, 2 * pi);
        points.push_back(map + 0.3 * std::cos(a) * u + 0.27 * std::sin(a) * v + dice.between(0, 1.5) * pipe.axis +
                         sigma * dice.normal() * normalised(std::cos(a) * u + std::sin(a) * v));
    }
    const Departure departure = departure_of(pipe, threshold, points);
    EXPECT_NEAR(departure.size, 0.0106, 0.0005);
    EXPECT_NEAR(departure.rest, sigma, 0.2 * sigma);
    EXPECT_GT(departure.share, 0.9);
    EXPECT_TRUE(departure.is_smooth(sigma));
    EXPECT_FALSE(departure.is_smooth(0)) << "noise that is not known";
}

// A tank of 310 mm, half axes 21 mm longer and shorter, seen by stations that are apart and mixed with points of its
// edges: what is left is three times the noise, so it is not smooth, but out of round it is. Not so where the oval is
// as small as that.
TEST(DepartureOf, ATankFarOutOfRoundIsDominant)
{
    const std::vector<std::array<double, 2>> cases{{0.021, 3}, {0.004, 3}, {0.004, 0.5}};  // oval, noise in sigmas
    for (const auto& [oval, noise] : cases) {
        pcm::Shape tank = of_kind(ShapeKind::cylinder);
        tank.radius = 0.31;
        const auto [u, v] = across(tank.axis);
        Dice dice(9);
        std::vector<Vec3d> points;
        for (int i = 0; i < 3000; ++i) {
            const double a = dice.between(0, 2 * pi);
            const Vec3d n = std::cos(a) * u + std::sin(a) * v;
            points.push_back(map + (0.31 + oval * std::cos(2 * a) + noise * sigma * dice.normal()) * n +
                             dice.between(0, 1.5) * tank.axis);
        }
        const Departure departure = departure_of(tank, 0.05, points);
        EXPECT_EQ(departure.is_smooth(sigma), noise < 1);
        EXPECT_EQ(departure.is_dominant(sigma), oval > 0.01) << departure.share << " " << departure.size;
        EXPECT_FALSE(departure.is_dominant(0)) << "noise that is not known";
    }
}

TEST(DepartureOf, ABulgedWallHasItsSize)
{
    Dice dice(5);
    std::vector<Vec3d> points;
    for (int i = 0; i < 3000; ++i) {
        const double x = dice.between(-3, 3), y = dice.between(-1, 1);
        points.push_back(map + Vec3d{x, y, x * x / 2000 - 0.0015 + sigma * dice.normal()});
    }
    pcm::Shape wall;
    wall.point = map;
    const Departure departure = departure_of(wall, threshold, points);
    EXPECT_NEAR(departure.size, 0.0045 * std::sqrt(4.0 / 45), 0.0002);  // rms of x^2 / 2000 about its mean
    EXPECT_TRUE(departure.is_smooth(sigma));
}

// Waves of 15 cm: errors that neighbours share, of which a surface of third degree is not the cause.
TEST(DepartureOf, ErrorsThatNeighboursShareLeaveTheirNoise)
{
    Dice dice(6);
    std::vector<Vec3d> points;
    for (int i = 0; i < 3000; ++i) {
        const double x = dice.between(-1, 1), y = dice.between(-1, 1);
        const double wave = 0.004 * std::sin(42 * x) * std::cos(38 * y) + 0.002 * x * x;
        points.push_back(map + Vec3d{x, y, wave + 0.0003 * dice.normal()});
    }
    pcm::Shape wall;
    wall.point = map;
    const Departure departure = departure_of(wall, threshold, points);
    EXPECT_FALSE(departure.is_smooth(0.0003));
    EXPECT_FALSE(departure.is_dominant(0.0003));
}

// A ceiling by a scanner that was carried: it hangs through, and errors that neighbours share are about as large as the
// noise. Before, "out of round, bent or bulged".
TEST(DepartureOf, WhatNeighboursStillShareIsNoSmoothSurface)
{
    pcm::Shape ceiling;
    ceiling.point = map;
    for (const double shared : {0.0, 0.002}) {
        Dice dice(7);
        std::vector<Vec3d> points;
        for (int i = 0; i < 3000; ++i) {
            const double x = dice.between(-1, 1), y = dice.between(-1, 1);
            const double wave = shared * std::sin(12 * x) * std::cos(11 * y);
            points.push_back(map + Vec3d{x, y, 0.006 * x * x - 0.002 + wave + sigma * dice.normal()});
        }
        const Departure departure = departure_of(ceiling, threshold, points);
        EXPECT_GT(departure.share, 0.3);
        EXPECT_LT(departure.rest, 1.3 * sigma);
        EXPECT_EQ(departure.agreement > 1.35, shared > 0) << departure.agreement;
        EXPECT_EQ(departure.is_smooth(sigma), shared == 0);
    }
}

}  // namespace
