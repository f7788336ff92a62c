// The steps in which a depth camera measures, of clouds whose steps are known.
#include "pcm/view/depth_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace pcm {
namespace {

constexpr double unit = 1e-4;

// Points at random in 2 x 2 units, at the height that `height` gives them; `axis` is the one along the view.
ChunkPositions cloud(std::size_t points, std::size_t axis, const std::function<double(double, double)>& height,
                     bool wide = false)
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> even(0, 2);
    ChunkPositions positions;
    positions.wide = wide;
    for (std::size_t i = 0; i < points; ++i) {
        const double u = even(random), v = even(random);
        const double place[3] = {u, v, height(u, v)};
        for (std::size_t a = 0; a < 3; ++a) {
            const auto at = static_cast<std::uint64_t>(std::llround(place[a] / unit));
            const std::size_t to = (a + axis + 1) % 3;
            if (wide)
                positions.wide_xyz[to].push_back(at + (std::uint64_t(1) << 40));
            else
                positions.narrow_xyz[to].push_back(static_cast<std::uint32_t>(at));
        }
    }
    return positions;
}

std::vector<float> steps_of(const ChunkPositions& positions, std::vector<std::uint32_t> levels = {})
{
    if (levels.empty()) levels = {static_cast<std::uint32_t>(positions.size())};
    return find_depth_steps(positions, {unit, unit, unit}, levels);
}

// Depths of a camera whose steps grow with the square of the distance.
double measured(double depth) { return 1 / (std::round(1 / depth / 0.003) * 0.003); }

TEST(DepthSteps, AreThoseOfTheCamera)
{
    for (const bool wide : {false, true})
        for (const std::size_t axis : {0u, 1u, 2u}) {
            const auto depth = [](double u, double v) { return measured(3 + 0.4 * u + 0.1 * std::sin(40 * v)); };
            const auto positions = cloud(20000, axis, depth, wide);
            const auto steps = steps_of(positions);
            ASSERT_EQ(steps.size(), 20000u);
            for (std::size_t i = 0; i < steps.size(); ++i) {
                const double z = wide ? static_cast<double>(positions.wide_xyz[axis][i] - (std::uint64_t(1) << 40))
                                      : static_cast<double>(positions.narrow_xyz[axis][i]);
                EXPECT_NEAR(static_cast<double>(steps[i]) / (0.003 * z * unit * z * unit), 1, 0.05);
            }
        }
}

// Three values are enough. Two may be a floor and a table.
TEST(DepthSteps, FewValues)
{
    const auto levels = [](int count) {
        return [count](double u, double v) { return 5 + 0.37 * (int(97 * u + 31 * v) % count); };
    };
    const auto three = steps_of(cloud(500, 2, levels(3)));
    ASSERT_EQ(three.size(), 500u);
    for (const float step : three) EXPECT_NEAR(static_cast<double>(step), 0.37, 2 * unit);
    EXPECT_TRUE(steps_of(cloud(500, 2, levels(2))).empty());
    EXPECT_TRUE(steps_of(cloud(500, 2, levels(1))).empty());
    EXPECT_TRUE(steps_of(cloud(50, 2, levels(7))).empty());
    EXPECT_TRUE(steps_of(ChunkPositions{}, {0}).empty());
}

// The treads of stairs and the cells of a grid are regular too.
TEST(DepthSteps, StairsAndGridsHaveNone)
{
    EXPECT_TRUE(steps_of(cloud(20000, 2, [](double, double v) { return 0.4 * int(2 * v); })).empty());
    ChunkPositions grid;
    std::mt19937_64 random(5);
    for (std::uint32_t i = 0; i < 14400; ++i)
        for (std::size_t a = 0; a < 3; ++a)
            grid.narrow_xyz[a].push_back(a == 0   ? i % 120 * 1000
                                         : a == 1 ? i / 120 * 1000
                                                  : static_cast<std::uint32_t>(random() % 5000));
    EXPECT_TRUE(steps_of(grid).empty());
}

TEST(DepthSteps, RoofsHaveNone)
{
    const double roofs[] = {0, 3.1, 4.4, 6.2, 9.9, 11, 15.3, 21};
    EXPECT_TRUE(steps_of(cloud(4000, 2, [&](double u, double v) {
                    return roofs[int(4 * u) % 2 + 2 * (int(4 * v) % 4)];
                })).empty());
}

// What is far behind the rest has steps of its own, and none between.
TEST(DepthSteps, OfTwoThingsAreTheirOwn)
{
    const auto positions = cloud(6000, 2, [](double u, double v) {
        const int step = int(50 * u + 7 * v) % 5;
        return u < 1 ? 2 + 0.02 * step : 6 + 0.1 * step;
    });
    const auto steps = steps_of(positions);
    ASSERT_EQ(steps.size(), 6000u);
    for (std::size_t i = 0; i < steps.size(); ++i)
        EXPECT_NEAR(static_cast<double>(steps[i]), positions.narrow_xyz[2][i] * unit < 4 ? 0.02 : 0.1, 2 * unit);
}

TEST(DepthSteps, ScannersHaveNone)
{
    EXPECT_TRUE(steps_of(cloud(20000, 2, [](double u, double v) { return 5 + std::sin(31 * u + 17 * v); })).empty());
    // As many values as there is room for, seen only after the first points.
    std::mt19937_64 random(5);
    std::size_t point = 0;
    EXPECT_TRUE(steps_of(cloud(20000, 2, [&](double, double) {
                    return ++point < 600 ? 5 : 5 + unit * static_cast<double>(random() % 4000);
                })).empty());
}

// A coarse level has too few points for its steps to be known; the others of the node are judged without it.
TEST(DepthSteps, EachLevelIsJudgedByItself)
{
    std::mt19937_64 random(5);
    std::size_t point = 0;
    const auto positions = cloud(3000, 2, [&](double u, double v) {
        return ++point <= 1000 ? 5 + 1e-3 * static_cast<double>(random() % 900) : 5 + 0.17 * (int(97 * u + 31 * v) % 4);
    });
    const auto steps = steps_of(positions, {1000, 2000});
    ASSERT_EQ(steps.size(), 3000u);
    EXPECT_TRUE(std::all_of(steps.begin(), steps.begin() + 1000, [](float s) { return s == 0; }));
    EXPECT_TRUE(std::all_of(steps.begin() + 1000, steps.end(), [](float s) { return s > 0; }));
    EXPECT_TRUE(steps_of(positions).empty());
}

}  // namespace
}  // namespace pcm
