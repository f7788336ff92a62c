// From the heights in cells to volumes: errors of heights against an integral, and turned upside down.
#include "pcm/measure/volume_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace pcm;

using Cells = std::vector<std::vector<HeightCell>>;

VolumeReport volumes_of(const CellGrid& grid, const Cells& cells, CellHeight height, EmptyCells empty)
{
    VolumeReport report;
    for (std::size_t cell = 0; cell < grid.size(); ++cell) report.area += grid.area(cell);
    add_volumes(report, grid, cells, height, empty);
    return report;
}

// E max(d + e, 0) - max(d, 0), e normal.
double excess_of(double d, double sigma)
{
    double sum = 0;
    constexpr int steps = 20000;
    for (int k = 0; k < steps; ++k) {
        const double z = -8 + 16 * (k + 0.5) / steps;
        sum += std::max(d + sigma * z, 0.0) * std::exp(-z * z / 2) / std::sqrt(2 * pi) * 16 / steps;
    }
    return sum - std::max(d, 0.0);
}

// One cell, whose height over the reference is from far below it to far above it in units of its error.
TEST(VolumeSums, ErrorsOfACellAreThoseOfANormalHeight)
{
    const CellGrid grid({{0, 0}, {3, 0}, {3, 2}, {0, 2}}, 100);
    ASSERT_EQ(grid.size(), 1u);
    for (double times = -3; times <= 3; times += 0.5) {
        // Four heights, two 0.3 above and two 0.3 below the mean: an error of sqrt(0.36 / 3 / 4).
        const double sigma = std::sqrt(0.03), mean = times * sigma;
        Cells cells(1, std::vector<HeightCell>(1));
        for (const double off : {-0.3, 0.3, 0.3, -0.3}) cells[0][0].add(mean + off);
        const VolumeReport report = volumes_of(grid, cells, CellHeight::mean, EmptyCells::left_out);
        EXPECT_NEAR(report.net(), 6 * mean, 1e-12);
        EXPECT_NEAR(report.cut, 6 * std::max(mean, 0.0), 1e-12);
        EXPECT_NEAR(report.net_spread, 6 * sigma, 1e-9);
        const double above = std::erfc(-times / std::sqrt(2.0)) / 2;
        EXPECT_NEAR(report.cut_spread, 6 * sigma * above, 1e-9) << times;
        EXPECT_NEAR(report.fill_spread, 6 * sigma * (1 - above), 1e-9) << times;
        EXPECT_NEAR(report.excess, 6 * excess_of(mean, sigma), 1e-6) << times;
        EXPECT_EQ(report.cells, 1u);
        EXPECT_EQ(report.cells_without_data, 0u);
        EXPECT_EQ(report.area_without_data, 0);
        EXPECT_NEAR(report.area_counted, 6, 1e-12);
    }
}

// Cells of a slope through the reference, with noise; every third has no points.
Cells slope(const CellGrid& grid, std::uint64_t seed, bool upside_down, double rise)
{
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0, 0.2);
    std::vector<HeightCell> cells(grid.size());
    for (std::size_t cell = 0; cell < grid.size(); ++cell)
        for (std::size_t n = random() % 3 ? 1 + random() % 6 : 0; n > 0; --n) {
            const double height = rise * (double(cell % grid.columns()) - 4.3) + normal(random);
            cells[cell].add(upside_down ? -height : height);
        }
    return {cells};
}

void expect_exchanged(const VolumeReport& a, const VolumeReport& b)
{
    const double near = 1e-9 * (a.cut + a.fill);
    EXPECT_GT(near, 0);
    EXPECT_NEAR(a.cut, b.fill, near);
    EXPECT_NEAR(a.fill, b.cut, near);
    EXPECT_NEAR(a.cut_spread, b.fill_spread, near);
    EXPECT_NEAR(a.fill_spread, b.cut_spread, near);
    EXPECT_NEAR(a.net_spread, b.net_spread, near);
    EXPECT_NEAR(a.cut_gaps, b.fill_gaps, near);
    EXPECT_NEAR(a.fill_gaps, b.cut_gaps, near);
    EXPECT_NEAR(a.net_gaps, b.net_gaps, near);
    EXPECT_NEAR(a.excess, b.excess, near);
    EXPECT_NEAR(a.cut_measured, b.fill_measured, near);
    EXPECT_NEAR(a.fill_measured, b.cut_measured, near);
    EXPECT_NEAR(a.cut_coarse, b.fill_coarse, near);
    EXPECT_NEAR(a.fill_coarse, b.cut_coarse, near);
    EXPECT_EQ(a.area_interpolated, b.area_interpolated);
    EXPECT_EQ(a.area_extrapolated, b.area_extrapolated);
    EXPECT_EQ(a.area_without_data, b.area_without_data);
}

// Upside down, what was cut is filled; and so it is between two clouds that change places.
TEST(VolumeSums, UpsideDownCutAndFillAreExchanged)
{
    const CellGrid grid({{0, 0}, {10.5, 1}, {9, 8.2}, {0.4, 9}}, 1);
    for (std::uint64_t seed = 1; seed <= 10; ++seed)
        for (const EmptyCells empty : {EmptyCells::interpolated, EmptyCells::left_out}) {
            const Cells up = slope(grid, seed, false, 0.3), down = slope(grid, seed, true, 0.3);
            expect_exchanged(volumes_of(grid, up, CellHeight::mean, empty),
                             volumes_of(grid, down, CellHeight::mean, empty));
            expect_exchanged(volumes_of(grid, up, CellHeight::highest, empty),
                             volumes_of(grid, down, CellHeight::lowest, empty));
            const std::vector<HeightCell> other = slope(grid, seed + 100, false, -0.1)[0];
            expect_exchanged(volumes_of(grid, {up[0], other}, CellHeight::mean, empty),
                             volumes_of(grid, {other, up[0]}, CellHeight::mean, empty));
        }
}

}  // namespace
