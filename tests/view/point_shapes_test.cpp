// What the surroundings of points look like, on shapes that are known.
#include "pcm/view/point_shapes.h"

#include "pcm/bpc/segments.h"
#include "pcm/cloud/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <random>

namespace pcm {
namespace {

using Places = std::vector<Vec3d>;

constexpr double step = 1e-4;

// In Morton order of cells of `cell`, as the points of a level are.
ChunkPositions sorted(Places places, double cell, bool wide = false, std::int64_t origin = 0)
{
    const auto code = [&](const Vec3d& p) {
        std::uint64_t bits = 0;
        for (unsigned bit = 21; bit-- > 0;)
            for (std::size_t a = 0; a < 3; ++a)
                bits = bits << 1 | (static_cast<std::uint64_t>((p[a] + 500) / cell) >> bit & 1u);
        return bits;
    };
    std::sort(places.begin(), places.end(), [&](const Vec3d& p, const Vec3d& q) { return code(p) < code(q); });
    Vec3d low{1e9, 1e9, 1e9};
    for (const Vec3d& p : places)
        for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]);
    ChunkPositions positions;
    positions.wide = wide;
    for (std::size_t a = 0; a < 3; ++a) {
        positions.origin[a] = origin;
        for (const Vec3d& p : places) {
            const auto relative = static_cast<std::uint64_t>(std::llround((p[a] - low[a]) / step));
            if (wide)
                positions.wide_xyz[a].push_back(relative + (std::uint64_t(1) << 40));
            else
                positions.narrow_xyz[a].push_back(static_cast<std::uint32_t>(relative));
        }
    }
    return positions;
}

std::vector<PointShape> shapes_of(const ChunkPositions& positions, std::vector<std::uint32_t> segments = {})
{
    if (segments.empty()) segments = {static_cast<std::uint32_t>(positions.size())};
    std::vector<PointShape> shapes;
    find_shapes(positions, {step, step, step}, segments, shapes);
    return shapes;
}

double share(const std::vector<PointShape>& shapes, Surroundings kind)
{
    const auto count =
        std::count_if(shapes.begin(), shapes.end(), [&](PointShape s) { return surroundings_of(s) == kind; });
    return static_cast<double>(count) / static_cast<double>(shapes.size());
}

// Points at random in the unit square or cube, mapped.
Places scattered(std::size_t count, const std::function<Vec3d(double, double, double)>& map)
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    Places places;
    for (std::size_t i = 0; i < count; ++i) {
        const double u = unit(random), v = unit(random), w = unit(random);
        places.push_back(map(u, v, w));
    }
    return places;
}

double angle(const Vec3d& a, const Vec3d& b) { return std::acos(std::min(1.0, std::fabs(dot(a, b)))) * 180 / pi; }

TEST(PointShapes, DirectionsAreKeptToADegree)
{
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 20000; ++i) {
        Vec3d d{normal(random), normal(random), normal(random)};
        if (i < 6)
            d = {i == 0 ? 1.0 : i == 1 ? -1.0 : 0, i == 2 ? 1.0 : i == 3 ? -1.0 : 0, i == 4 ? 1.0 : i == 5 ? -1.0 : 0};
        d = normalised(d);
        for (const Surroundings kind : {Surroundings::surface, Surroundings::line}) {
            const PointShape shape = shape_of(kind, d);
            EXPECT_EQ(surroundings_of(shape), kind);
            EXPECT_LT(angle(direction_of(shape), d), 0.95);
            EXPECT_GT(dot(direction_of(shape), d), 0);
            EXPECT_LT(shape, 1u << shape_bits);
        }
    }
}

TEST(PointShapes, PointsOnATiltedPlaneLieInIt)
{
    const Vec3d n = normalised(Vec3d{0.3, -0.5, 0.8});
    const Vec3d u = normalised(cross(n, Vec3d{1, 0, 0})), v = cross(n, u);
    const auto shapes =
        shapes_of(sorted(scattered(5000, [&](double a, double b, double) { return 20 * a * u + 20 * b * v; }), 0.1));
    EXPECT_GT(share(shapes, Surroundings::surface), 0.93);
    for (const PointShape shape : shapes) {
        EXPECT_GT(size_factor(shape), 0.65);
        if (surroundings_of(shape) == Surroundings::surface) EXPECT_LT(angle(direction_of(shape), n), 1);
    }
}

TEST(PointShapes, NoiseBelowTheSpacingDoesNotHideASurface)
{
    for (const double sigma : {0.1, 0.3, 0.5}) {
        std::mt19937_64 random(5);
        std::normal_distribution<double> noise(0, sigma);
        const auto shapes = shapes_of(sorted(scattered(6400,
                                                       [&](double a, double b, double) {
                                                           return Vec3d{80 * a, 80 * b, noise(random)};
                                                       }),
                                             0.3));
        EXPECT_GT(share(shapes, Surroundings::surface), sigma < 0.4 ? 0.9 : 0.75) << sigma;
        double sum = 0;
        std::size_t small = 0;
        for (const PointShape shape : shapes) {
            small += size_factor(shape) < 0.5;
            sum += size_factor(shape);
        }
        EXPECT_GT(sum / static_cast<double>(shapes.size()), 0.9) << sigma;
        EXPECT_LE(small, shapes.size() / 20) << sigma;
    }
}

TEST(PointShapes, ACloudOfLeavesIsAVolume)
{
    const auto shapes = shapes_of(sorted(scattered(8000,
                                                   [](double a, double b, double c) {
                                                       return Vec3d{20 * a, 20 * b, 20 * c};
                                                   }),
                                         0.3));
    EXPECT_GT(share(shapes, Surroundings::volume), 0.92);
    double sum = 0;
    for (const PointShape shape : shapes) sum += size_factor(shape);
    EXPECT_LT(sum / static_cast<double>(shapes.size()), 0.36);
}

TEST(PointShapes, AWireIsALineAlongIt)
{
    std::mt19937_64 random(11);
    std::normal_distribution<double> noise(0, 0.003);
    const Vec3d along = normalised(Vec3d{0.9, 0.4, 0.1});
    const auto shapes = shapes_of(sorted(scattered(2000,
                                                   [&](double a, double, double) {
                                                       const Vec3d off{noise(random), noise(random), noise(random)};
                                                       return 60 * a * along + off;
                                                   }),
                                         0.02));
    EXPECT_GT(share(shapes, Surroundings::line), 0.95);
    for (const PointShape shape : shapes)
        if (surroundings_of(shape) == Surroundings::line) EXPECT_LT(angle(direction_of(shape), along), 3);
}

// The surface stays closed there: points next to an edge are not a volume.
TEST(PointShapes, ACreaseShrinksLittle)
{
    const auto shapes =
        shapes_of(sorted(scattered(8000,
                                   [](double a, double b, double c) {
                                       return c < 0.5 ? Vec3d{20 * a, 10 * b, 0} : Vec3d{20 * a, 0, 10 * b};
                                   }),
                         0.1));
    std::size_t small = 0;
    for (const PointShape shape : shapes) small += size_factor(shape) < 0.65;
    EXPECT_LT(small, shapes.size() / 50);
    EXPECT_GT(share(shapes, Surroundings::surface), 0.75);
}

TEST(PointShapes, DependOnNeitherOriginNorWidthNorUnit)
{
    const Places places = scattered(3000, [](double a, double b, double c) {
        return c < 0.5 ? Vec3d{30 * a, 30 * b, std::sin(9 * a)} : Vec3d{30 * a, 30 * b, 30 * c};
    });
    const auto narrow = shapes_of(sorted(places, 0.3)), wide = shapes_of(sorted(places, 0.3, true, -1234567890123));
    EXPECT_EQ(narrow, wide);
    std::vector<PointShape> tiny, huge;
    const ChunkPositions positions = sorted(places, 0.3);
    find_shapes(positions, {1e-30, 1e-30, 1e-30}, {3000}, tiny);
    find_shapes(positions, {1e25, 1e25, 1e25}, {3000}, huge);
    EXPECT_EQ(narrow, tiny);
    EXPECT_EQ(narrow, huge);
}

// A reader of some of a chunk's segments finds what a reader of all does.
TEST(PointShapes, OfASegmentAreThoseOfTheChunk)
{
    const std::uint32_t count = 20000;
    const ChunkPositions all =
        sorted(scattered(count,
                         [](double a, double b, double c) {
                             return c < 0.6 ? Vec3d{30 * a, 30 * b, 0} : Vec3d{30 * a, 30 * b, 9 * c};
                         }),
               0.1);
    ChunkIdentity identity{};
    identity.level_points = {777, 5000, count - 5777};
    Node node;
    node.points = count;
    node.level_points = identity.level_points;
    const auto whole = shapes_of(all, points_of_segments(node));
    for (const BpcSegment& segment : segments_of(identity, count)) {
        ChunkPositions part;
        for (std::size_t a = 0; a < 3; ++a) {
            const auto from = all.narrow_xyz[a].begin() + segment.first;
            part.narrow_xyz[a].assign(from, from + segment.count);
        }
        const auto shapes = shapes_of(part);
        EXPECT_TRUE(std::equal(shapes.begin(), shapes.end(), whole.begin() + segment.first)) << segment.first;
    }
}

TEST(PointShapes, FewPointsAndPilesAreNotJudged)
{
    const auto few = shapes_of(sorted(scattered(15, [](double a, double b, double) { return Vec3d{a, b, 0}; }), 0.1));
    EXPECT_EQ(share(few, Surroundings::unknown), 1);
    const auto pile = shapes_of(sorted(Places(200, Vec3d{1, 2, 3}), 0.1));
    EXPECT_EQ(share(pile, Surroundings::unknown), 1);
    for (const PointShape shape : pile) EXPECT_EQ(size_factor(shape), 1);
    EXPECT_TRUE(shapes_of(ChunkPositions{}, {0}).empty());
}

TEST(PointShapes, ARadiusKeepsItsSizeBesideAShape)
{
    for (const float radius : {1e-30f, 0.001f, 0.9999f, 1.0f, 3.7f, 1e18f})
        for (const PointShape shape : {0u, 0x3ffffu, shape_of(Surroundings::surface, {0, 0, 1}), volume_shape(0.4)}) {
            const float packed = with_shape(radius, shape);
            std::uint32_t bits;
            std::memcpy(&bits, &packed, 4);
            EXPECT_EQ(bits & 0x3ffffu, shape);
            bits = (bits & ~0x3ffffu) | 0x20000u;  // as shaders/splat.vert
            float read;
            std::memcpy(&read, &bits, 4);
            EXPECT_NEAR(read / radius, 1, 1.0 / 64);
            EXPECT_LE(static_cast<double>(read), static_cast<double>(radius) * largest_of_packed);
        }
    EXPECT_EQ(with_shape(0, 0x3ffffu), 0);
    EXPECT_EQ(with_shape(-1, 5), 0);
}

TEST(PointShapes, ASteppedSurfaceKeepsItsNormalAndItsSteps)
{
    std::mt19937_64 random(31);
    std::normal_distribution<double> normal;
    for (double step = 2; step < 200; step *= 1.13) {
        const Vec3d n = normalised(Vec3d{normal(random), normal(random), normal(random)});
        const PointShape shape = with_steps(shape_of(Surroundings::surface, n), 3 * step, 3);
        EXPECT_TRUE(is_stepped(shape)) << step;
        EXPECT_EQ(surroundings_of(shape), Surroundings::surface);
        EXPECT_EQ(size_factor(shape), surface_factor);
        EXPECT_LT(angle(direction_of(shape), n), 3);
        EXPECT_NEAR(step_of(shape) / step, 1, 0.2);
        EXPECT_EQ(shape >> 16, 0u);
        EXPECT_EQ(with_steps(shape, 50, 1), with_steps(shape_of(Surroundings::surface, direction_of(shape)), 50, 1));
    }
    EXPECT_NEAR(step_of(with_steps(shape_of(Surroundings::surface, {0, 0, 1}), 1e9, 1)), 256, 1);
}

TEST(PointShapes, OnlySurfacesWithDeepStepsAreStepped)
{
    const PointShape surface = shape_of(Surroundings::surface, {0, 0, 1});
    for (const double step : {0.0, 1.0, 1.6, std::nan("")}) EXPECT_EQ(with_steps(surface, step, 1), surface) << step;
    EXPECT_EQ(with_steps(surface, 0, 0), surface);
    for (const PointShape other : {0u, volume_shape(0), volume_shape(1), shape_of(Surroundings::line, {0, 1, 0})}) {
        EXPECT_EQ(with_steps(other, 10, 1), other);
        EXPECT_FALSE(is_stepped(other));
        EXPECT_EQ(step_of(other), 0);
    }
}

TEST(PointShapes, VolumesAreSmallerTheRounderTheyAre)
{
    EXPECT_EQ(size_factor(volume_shape(0)), 1);
    EXPECT_DOUBLE_EQ(size_factor(volume_shape(1)), least_volume_factor);
    EXPECT_EQ(volume_shape(7), volume_shape(1));
    EXPECT_NEAR(volume_of(volume_shape(0.3)), 0.3, 1e-5);
    EXPECT_EQ(size_factor(shape_of(Surroundings::surface, {0, 1, 0})), surface_factor);
    EXPECT_EQ(size_factor(shape_of(Surroundings::line, {0, 1, 0})), 1);
}

}  // namespace
}  // namespace pcm
