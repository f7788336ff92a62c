// The plane through a grid of heights, its coarser grid and Laplace's equation, each against its definition.
#include "pcm/measure/cell_field.h"

#include "pcm/cloud/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::cells;

// Heights around `middle`; about a quarter of the cells are gaps, and as many are outside.
Field random_field(std::size_t columns, std::size_t rows, double middle, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    Field field;
    field.columns = columns;
    for (std::size_t cell = 0; cell < columns * rows; ++cell) {
        field.height.push_back(random() % 4 ? middle + unit(random) : not_a_number);
        field.area.push_back(random() % 4 ? 0.1 + unit(random) : 0);
    }
    return field;
}

// The mean of the cells next to one that have an area, NaN where there are none.
double mean_around(const Field& field, std::size_t cell)
{
    const auto x = static_cast<int>(cell % field.columns), y = static_cast<int>(cell / field.columns);
    double sum = 0;
    int count = 0;
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int column = x + dx, row = y + dy;
        if (column < 0 || row < 0 || column >= static_cast<int>(field.columns) || row >= static_cast<int>(field.rows()))
            continue;
        const auto other = static_cast<std::size_t>(row) * field.columns + static_cast<std::size_t>(column);
        if (!(field.area[other] > 0)) continue;
        sum += field.height[other];
        ++count;
    }
    return count ? sum / count : not_a_number;
}

// Where the sum of a (z - plane)^2 and of a quarter of all areas times the squares of the slopes is least, its
// derivatives are 0.
TEST(CellField, ThePlaneIsThatOfLeastSquaresWithSlopesDrawnTowards0)
{
    for (const auto& [columns, rows] : {std::pair<std::size_t, std::size_t>{7, 5}, {1, 9}, {12, 1}, {2, 2}}) {
        const Field field = random_field(columns, rows, 3, columns);
        const CellPlane plane = plane_through(field);
        double weight = 0, by_height = 0, by_x = 0, by_y = 0;
        for (std::size_t cell = 0; cell < field.height.size(); ++cell) {
            if (!field.known(cell)) continue;
            const double left = field.area[cell] * (field.height[cell] - plane.at(cell, columns));
            weight += field.area[cell];
            by_height += left;
            by_x += left * static_cast<double>(cell % columns);
            by_y += left * static_cast<double>(cell / columns);
        }
        ASSERT_GT(weight, 0);
        EXPECT_NEAR(by_height, 0, 1e-12);
        EXPECT_NEAR(by_x, weight / 4 * plane.b, 1e-12);
        EXPECT_NEAR(by_y, weight / 4 * plane.c, 1e-12);
    }
    Field one{{not_a_number, 5, 7}, {1, 2, 0}, 3};
    EXPECT_EQ(plane_through(one).at(0, 3), 5);
    EXPECT_EQ(plane_through(one).at(2, 3), 5);
    one.area[1] = 0;
    EXPECT_EQ(plane_through(one).at(1, 3), 0) << "nothing is known";
}

TEST(CellField, CoarserCellsHaveTheMeanOfTheKnownOnesAndTheAreaOfAll)
{
    for (const auto& [columns, rows] : {std::pair<std::size_t, std::size_t>{7, 5}, {6, 4}, {1, 3}}) {
        const Field fine = random_field(columns, rows, 3, rows);
        const Field coarse = coarser(fine);
        ASSERT_EQ(coarse.columns, (columns + 1) / 2);
        ASSERT_EQ(coarse.rows(), (rows + 1) / 2);
        ASSERT_EQ(coarse.area.size(), coarse.height.size());
        for (std::size_t to = 0; to < coarse.height.size(); ++to) {
            double area = 0, known = 0, sum = 0;
            for (std::size_t cell = 0; cell < fine.height.size(); ++cell) {
                if (cell % columns / 2 != to % coarse.columns || cell / columns / 2 != to / coarse.columns) continue;
                area += fine.area[cell];
                if (!fine.known(cell)) continue;
                known += fine.area[cell];
                sum += fine.area[cell] * fine.height[cell];
            }
            EXPECT_NEAR(coarse.area[to], area, 1e-12);
            if (known > 0)
                EXPECT_NEAR(coarse.height[to], sum / known, 1e-12);
            else
                EXPECT_TRUE(std::isnan(coarse.height[to]));
        }
    }
}

// Far from 0, too: how exact a height is depends on the range of the heights.
TEST(CellField, GapsAreTheMeanOfTheCellsNextToThem)
{
    for (const double middle : {0.0, 1e6, -1e6})
        for (const auto& [columns, rows] : {std::pair<std::size_t, std::size_t>{9, 7}, {1, 8}, {6, 1}, {24, 24}}) {
            const Field before = random_field(columns, rows, middle, 2 * columns + rows);
            Field field = before;
            int checks = 0;
            solve_laplace(field, [&] { ++checks; });
            EXPECT_GT(checks, 0);
            std::size_t solved = 0;
            for (std::size_t cell = 0; cell < field.height.size(); ++cell) {
                if (!before.gap(cell)) {
                    EXPECT_TRUE(field.height[cell] == before.height[cell] || std::isnan(before.height[cell])) << cell;
                    EXPECT_EQ(std::isnan(field.height[cell]), std::isnan(before.height[cell])) << cell;
                    continue;
                }
                const double around = mean_around(field, cell);
                if (std::isnan(around)) {  // filled by the cells around on coarser grids
                    EXPECT_GE(field.height[cell], middle) << cell;
                    EXPECT_LE(field.height[cell], middle + 1) << cell;
                    continue;
                }
                EXPECT_NEAR(field.height[cell], around, 1e-5) << cell;
                ++solved;
            }
            EXPECT_GT(solved, 0u);
        }
}

// A polygon that holds no points: the plane that was taken away is all there is.
TEST(CellField, WithoutAKnownCellGapsAre0)
{
    const Field nothing{std::vector<double>(12, not_a_number), {1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1}, 4};
    for (const auto& work : {solve_laplace, fill}) {
        Field field = nothing;
        work(field, {});
        for (std::size_t cell = 0; cell < 12; ++cell)
            if (cell == 2)
                EXPECT_TRUE(std::isnan(field.height[cell]));
            else
                EXPECT_EQ(field.height[cell], 0) << cell;
    }
}

// A slope is filled exactly, to its borders.
TEST(CellField, FillingTakesTheSlopeAwayFirst)
{
    constexpr std::size_t columns = 40;
    Field field;
    field.columns = columns;
    const auto slope = [](std::size_t cell) {
        return 20 + 0.5 * static_cast<double>(cell % columns) - 0.25 * static_cast<double>(cell / columns);
    };
    for (std::size_t cell = 0; cell < 30 * columns; ++cell) {
        field.area.push_back(1);
        field.height.push_back(cell % columns > 5 && cell % columns < 36 ? slope(cell) : not_a_number);
    }
    fill(field, {});
    for (std::size_t cell = 0; cell < field.height.size(); ++cell)
        EXPECT_NEAR(field.height[cell], slope(cell), 0.02) << cell;
}

}  // namespace
