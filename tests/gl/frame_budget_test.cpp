#include "gl/frame_budget.h"
#include "gl/vertex_colours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

using namespace pcm;

namespace {

FrameWork work(std::uint64_t points) { return {points, points, 0}; }

// A device that needs `cost` ms a point and draws as many as it is given, up to `visible`.
double settle(FrameBudget& budget, double cost, double budget_ms, std::uint64_t visible, std::uint64_t ceiling,
              int frames)
{
    double ms = 0;
    for (int i = 0; i < frames; ++i) {
        const std::uint64_t points = std::min(budget.points(budget_ms, 0, ceiling), visible);
        ms = cost * static_cast<double>(points);
        budget.measured(work(points), ms);
    }
    return ms;
}

template <class T>
Column column_of(ScalarType type, std::uint32_t components, const std::vector<T>& values)
{
    Column column(type, components);
    column.resize(values.size() / components);
    std::memcpy(column.data(), values.data(), values.size() * sizeof(T));
    return column;
}

}  // namespace

TEST(FrameBudget, SettlesBelowTheAskedTimeOnFastAndSlowDevices)
{
    for (const double cost : {1e-7, 1e-6, 1e-5, 1e-4}) {
        FrameBudget budget;
        const double ms = settle(budget, cost, 33, 1'000'000'000, 1'000'000'000, 300);
        EXPECT_LT(ms, 33) << "ms a point " << cost;
        EXPECT_GT(ms, 0.65 * 33) << "ms a point " << cost;
    }
}

// What a frame takes beside its points is left for it.
TEST(FrameBudget, LeavesRoomForTheRestOfTheFrame)
{
    FrameBudget budget;
    for (int i = 0; i < 100; ++i) {
        const std::uint64_t points = budget.points(33, 0, 1'000'000'000);
        budget.measured(work(points), 1e-5 * static_cast<double>(points));
        budget.measured_overhead(12);
    }
    const double ms = 12 + 1e-5 * static_cast<double>(budget.points(33, 0, 1'000'000'000));
    EXPECT_LT(ms, 33);
    EXPECT_GT(ms, 22);
    for (int i = 0; i < 10; ++i) budget.measured_overhead(100);  // nothing is left: the least
    EXPECT_EQ(budget.points(33, 0, 1'000'000'000), FrameBudget::least);
}

TEST(FrameBudget, StaysPutOnceSettledAndFollowsAChange)
{
    FrameBudget budget;
    settle(budget, 1e-5, 33, 1'000'000'000, 1'000'000'000, 100);
    const std::uint64_t settled = budget.points(33, 0, 1'000'000'000);
    for (int i = 0; i < 100; ++i) {  // 4 % noise
        budget.measured(work(settled), 1e-5 * static_cast<double>(settled) * (i % 2 ? 1.02 : 0.98));
        EXPECT_EQ(budget.points(33, 0, 1'000'000'000), settled);
    }
    EXPECT_NEAR(settle(budget, 5e-5, 33, 1'000'000'000, 1'000'000'000, 200), 27, 6);
    EXPECT_NEAR(settle(budget, 1e-5, 33, 1'000'000'000, 1'000'000'000, 200), 27, 6);
}

// Splats that have grown cost by the pixel: they leave time for more points, which make them smaller.
TEST(FrameBudget, GrownSplatsDoNotKeepThePointsFew)
{
    for (const double per_pixel : {1e-7, 1e-6, 5e-6}) {
        FrameBudget budget;
        const double per_point = 1e-5, budget_ms = 33;
        std::uint64_t points = 20000;
        double ms = 0;
        for (int frame = 0; frame < 200; ++frame) {
            points = std::min<std::uint64_t>(budget.points(budget_ms, 20000, 1'000'000'000), 10'000'000);
            // Points that are even in the picture, whose splats leave no gaps; below a size of their own they do not grow.
            const double spacing = std::sqrt(3e6 / static_cast<double>(points));
            const double grown = spacing > 1.4 ? 2e6 : 0;
            ms = per_point * static_cast<double>(points) + per_pixel * grown;
            budget.measured({points, points, grown}, ms);
        }
        EXPECT_LT(ms, budget_ms) << per_pixel;
        EXPECT_GT(static_cast<double>(points), 0.2 * budget_ms / per_point) << per_pixel;
    }
}

// Chunks near the eye whose splats are quads have four vertices a point; they say nothing of what the others cost.
TEST(FrameBudget, QuadsDoNotMakePointsDear)
{
    FrameBudget budget;
    std::uint64_t points = 0;
    for (int frame = 0; frame < 100; ++frame) {
        points = budget.points(33, 20000, 1'000'000'000);
        const std::uint64_t vertices = points + 3 * 20000;
        budget.measured({points, vertices, 0}, 1e-4 * static_cast<double>(vertices));
    }
    EXPECT_GT(points + 60000, 0.5 * 33 / 1e-4);
    EXPECT_LT(points + 60000, 33 / 1e-4);
}

// One slow frame is answered in the next one, in part: it may have been the last.
TEST(FrameBudget, GivesWayAtOnce)
{
    FrameBudget budget;
    settle(budget, 1e-5, 33, 1'000'000'000, 1'000'000'000, 100);
    const std::uint64_t before = budget.points(33, 0, 1'000'000'000);
    budget.measured(work(before), 3 * 1e-5 * static_cast<double>(before));
    EXPECT_LT(budget.points(33, 0, 1'000'000'000), 0.8 * static_cast<double>(before));
}

TEST(FrameBudget, KeepsItsBounds)
{
    FrameBudget budget;
    for (int i = 0; i < 10; ++i) budget.measured(work(1'000'000), 1e6);
    EXPECT_EQ(budget.points(33, 0, 1'000'000'000), FrameBudget::least);
    EXPECT_EQ(budget.points(33, 250'000, 1'000'000'000), 250'000u);  // the coarsest chunk is always drawn
    EXPECT_EQ(budget.points(33, 250'000, 5'000), 5'000u);            // but the user's limit wins
    EXPECT_FALSE(budget.can_grow(33, 5'000));
    EXPECT_EQ(budget.points(33, 0, 0), 0u);
    for (int i = 0; i < 120; ++i) budget.measured(work(1'000'000), 0.001);
    std::uint64_t before = budget.points(33, 0, 50'000'000);
    for (int i = 0; i < 40; ++i) {
        const std::uint64_t now = budget.points(33, 0, 50'000'000);
        EXPECT_LE(now, 2 * before);
        before = now;
    }
    EXPECT_EQ(before, 50'000'000u);
    EXPECT_FALSE(budget.can_grow(33, 50'000'000));
    EXPECT_EQ(budget.points(std::numeric_limits<double>::infinity(), 0, 60'000'000), 60'000'000u);  // no time limit at all
}

TEST(VertexColours, EveryTypeFillsTheRange)
{
    const auto scaled = [](const Column& column, VertexColour colour) {
        std::vector<std::uint8_t> rgba;
        make_colours(column, ColourScale::of(column, colour), rgba);
        return rgba;
    };
    using Bytes = std::vector<std::uint8_t>;
    EXPECT_EQ(scaled(column_of<std::uint8_t>(ScalarType::u8, 3, {0, 128, 255}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<std::uint8_t>(ScalarType::u8, 3, {0, 1, 2}), VertexColour::rgb), (Bytes{0, 1, 2, 255}));
    EXPECT_EQ(scaled(column_of<std::uint16_t>(ScalarType::u16, 3, {0, 128 * 257, 65535}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<std::uint16_t>(ScalarType::u16, 3, {0, 128, 255}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<float>(ScalarType::f32, 3, {0.0f, 0.5f, 1.0f}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<double>(ScalarType::f64, 3, {0.0, 128.0, 255.0}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<float>(ScalarType::f32, 3, {std::nanf(""), -4.0f, 1.0f}), VertexColour::rgb),
              (Bytes{0, 0, 255, 255}));

    const auto grey = scaled(column_of<std::int16_t>(ScalarType::i16, 1, {-300, 0, 300}), VertexColour::intensity);
    EXPECT_EQ(grey[0], 0);
    EXPECT_NEAR(grey[4], 128, 1);
    EXPECT_EQ(grey[8], 255);
    EXPECT_EQ(grey[8], grey[9]);
    const auto flat = scaled(column_of<std::uint16_t>(ScalarType::u16, 1, {7, 7}), VertexColour::intensity);
    EXPECT_EQ(flat, (Bytes{255, 255, 255, 255, 255, 255, 255, 255}));

    // One hot pixel does not darken the rest.
    std::vector<float> values(1000);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
    values[500] = 1e30f;
    const auto robust = scaled(column_of<float>(ScalarType::f32, 1, values), VertexColour::intensity);
    EXPECT_GT(robust[4 * 990], 240);
}
