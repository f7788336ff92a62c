// What a tree records of the points that were appended: rounding, points left out, type of positions.

#include "pcm/update/append.h"

#include "tests/update/model.h"

#include <cmath>
#include <limits>

namespace {

using namespace pcm;
using namespace pcm::test;

class AppendInfo : public testing::Test {
protected:
    TreeInfo info() const { return Tree::open(path_)->info(); }
    AppendReport append(const MemoryCloud& cloud) const
    {
        MemoryReader reader(cloud);
        AppendOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        options.threads = 2;
        return append_points(path_, reader, {"more"}, options);
    }

    // Doubles on places of the grid that may be `beyond` steps off, in the first point.
    static MemoryCloud on(const Grid& grid, double beyond, std::uint64_t seed, std::size_t count = 500)
    {
        MemoryCloud cloud = random_cloud({}, std::nullopt, count, seed);
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t i = 0; i < count; ++i) {
                double& value = cloud.points.xyz[a][i];
                const auto q = static_cast<std::int64_t>(std::llrint((value - grid.offset[a]) / grid.scale[a]));
                value = grid.to_source(q, a);
            }
        // Near zero doubles are finer than any grid.
        const auto zero = static_cast<std::int64_t>(std::llrint(-grid.offset[0] / grid.scale[0]));
        cloud.points.xyz[0][0] = grid.to_source(zero, 0) + beyond * grid.scale[0];
        return cloud;
    }

    // By how much the first coordinate of the first point is rounded.
    static double rounding(const MemoryCloud& cloud, const Grid& grid)
    {
        const double value = cloud.points.xyz[0][0];
        const auto q = static_cast<std::int64_t>(std::llrint((value - grid.offset[0]) / grid.scale[0]));
        return std::fabs(grid.to_source(q, 0) - value);
    }

    const TemporaryFolder folder_;
    const std::filesystem::path path_ = folder_ / "tree.pct";
};

// Doubles on a grid of 64 bits: half a step is allowed.
TEST_F(AppendInfo, ThePositionErrorIsTheLargestOfAll)
{
    build(random_cloud({}, std::nullopt, 500, 3), path_);
    const TreeInfo first = info();
    ASSERT_TRUE(first.wide);
    ASSERT_EQ(first.position_type, ScalarType::f64);
    double largest = first.position_error;
    std::uint64_t seed = 10;
    for (const double beyond : {0.0, 0.25, -0.375, 0.125}) {
        const MemoryCloud cloud = on(first.grid, beyond, seed++);
        largest = std::max(largest, rounding(cloud, first.grid));
        const AppendReport report = append(cloud);
        EXPECT_EQ(report.outcome.error, largest) << beyond;
        EXPECT_EQ(info().position_error, largest) << beyond;
    }
    EXPECT_EQ(largest, 0.375 * first.grid.scale[0]);
}

// Doubles that are a few units in the last place off the grid of a tree of integers.
TEST_F(AppendInfo, WhatTheReaderRoundsCounts)
{
    build(surface(500, 0, 0, 10, 4), path_);
    const TreeInfo first = info();
    ASSERT_EQ(first.position_type, ScalarType::i32);
    ASSERT_EQ(first.position_error, 0);
    const auto doubles_beside = [&](int units, std::uint64_t seed) {
        MemoryCloud cloud = surface(500, 0, 0, 10, seed);
        cloud.points.reset(cloud.info.schema, false, 500);
        cloud.info.position_type = ScalarType::f64;
        cloud.info.grid.reset();
        const MemoryCloud from = surface(500, 0, 0, 10, seed);
        for (std::size_t i = 0; i < 500; ++i)
            for (std::size_t a = 0; a < 3; ++a)
                cloud.points.xyz[a][i] = first.grid.to_source(from.points.grid_xyz[a][i], a);
        for (double& value = cloud.points.xyz[0][0]; units > 0; --units) value = std::nextafter(value, 1e9);
        return cloud;
    };
    const MemoryCloud cloud = doubles_beside(1, 5);
    const double error = rounding(cloud, first.grid);
    ASSERT_GT(error, 0);
    EXPECT_EQ(append(cloud).outcome.error, error);
    EXPECT_EQ(info().position_error, error);
    // A later append that is exact does not make it forgotten.
    EXPECT_EQ(append(doubles_beside(0, 6)).outcome.error, error);
    EXPECT_EQ(info().position_error, error);
}

// By the partition in a tree of doubles, by the reader that fits them in a tree of integers.
TEST_F(AppendInfo, PointsWithoutAFinitePositionAreCounted)
{
    for (const bool wide : {false, true}) {
        const auto punch = [](MemoryCloud cloud, std::size_t holes) {
            for (std::size_t i = 0; i < holes; ++i)
                cloud.points.xyz[i % 3][40 * i] =
                    i % 2 ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
            return cloud;
        };
        std::uint64_t points = 500, skipped = 0;
        if (wide) {
            build(punch(random_cloud({}, std::nullopt, 500, 7), 2), path_);
            points -= 2, skipped += 2;
        } else {
            MemoryCloud integers = random_cloud({}, Grid{{0.25, 0.25, 0.25}, {0, 0, 0}}, 500, 7);
            build(integers, path_);
        }
        ASSERT_EQ(info().wide, wide);
        ASSERT_EQ(info().points_skipped, skipped);
        for (const std::size_t holes : {std::size_t(3), std::size_t(0), std::size_t(1)}) {
            const AppendReport report = append(punch(on(info().grid, 0, 8 + holes), holes));
            points += 500 - holes;
            skipped += holes;
            EXPECT_EQ(report.points_skipped, holes);
            EXPECT_EQ(report.points_added, 500 - holes);
            EXPECT_EQ(report.outcome.points_in, 500u);
            EXPECT_EQ(report.outcome.points_out, points);
            EXPECT_EQ(report.notes.empty(), holes == 0);
            EXPECT_EQ(info().points_skipped, skipped) << (wide ? "wide" : "narrow");
            EXPECT_EQ(info().points, points);
        }
    }
}

// Only a tree whose positions are all floats gives floats back.
TEST_F(AppendInfo, ThePositionTypeIsThatOfAllPoints)
{
    const Grid quarters{{0.25, 0.25, 0.25}, {0, 0, 0}};
    const auto of = [&](ScalarType type, std::uint64_t seed) {
        MemoryCloud cloud = on(quarters, 0, seed);
        cloud.info.position_type = type;
        return cloud;
    };
    for (const ScalarType more : {ScalarType::f32, ScalarType::f64, ScalarType::i32}) {
        build(of(ScalarType::f32, 9), path_);
        ASSERT_EQ(info().position_type, ScalarType::f32);
        append(of(more, 10));
        EXPECT_EQ(info().position_type, more == ScalarType::f32 ? ScalarType::f32 : ScalarType::f64) << name_of(more);
    }
    const MemoryCloud integers = surface(500, 0, 0, 10, 11);
    build(integers, path_);
    ASSERT_EQ(info().position_type, ScalarType::i32);
    append(surface(500, 5, 0, 10, 12));
    EXPECT_EQ(info().position_type, ScalarType::i32);
}

}  // namespace
