// Cells of a grid over a polygon, against the polygon itself.
#include "pcm/measure/cell_grid.h"

#include "pcm/cloud/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace pcm;

// Even-odd rule, edge by edge.
bool is_in(const std::vector<Vec2d>& polygon, const Vec2d& p)
{
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Vec2d &a = polygon[j], &b = polygon[i];
        if ((a[1] > p[1]) == (b[1] > p[1])) continue;
        const double side = turn(a, b, p);
        if (b[1] > a[1] ? side > 0 : side < 0) inside = !inside;
    }
    return inside;
}

TEST(CellGrid, AreasAddUpToThePolygon)
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0.2, 1);
    for (int round = 0; round < 60; ++round) {
        const Vec2d at = round % 2 ? Vec2d{5e6, -4.8e6} : Vec2d{0, 0};
        std::vector<Vec2d> polygon;
        const std::size_t count = 3 + random() % 40;
        std::vector<Vec3d> corners;
        for (std::size_t i = 0; i < count; ++i) {
            const double t = 2 * pi * static_cast<double>(i) / static_cast<double>(count), r = 10 * unit(random);
            polygon.push_back({at[0] + r * std::cos(t), at[1] + r * std::sin(t)});
            corners.push_back({polygon.back()[0], polygon.back()[1], 0});
        }
        if (round % 3 == 0) std::reverse(polygon.begin(), polygon.end());
        const CellGrid grid(polygon, 0.1 + unit(random));
        double sum = 0;
        for (std::size_t cell = 0; cell < grid.size(); ++cell) {
            sum += grid.area(cell);
            EXPECT_LE(grid.area(cell), grid.side() * grid.side() * (1 + 1e-9));
        }
        const double area = std::fabs(vector_area(corners)[2]);
        EXPECT_NEAR(sum, area, 1e-9 * area);
        // Points are in the cell of their place exactly when they are in the polygon.
        std::uniform_real_distribution<double> place(-11, 11);
        for (int i = 0; i < 500; ++i) {
            const Vec2d p{at[0] + place(random), at[1] + place(random)};
            const std::size_t cell = grid.cell_of(p[0], p[1]);
            ASSERT_EQ(cell < grid.size(), is_in(polygon, p));
            if (cell < grid.size()) {
                EXPECT_GT(grid.area(cell), 0);
            }
        }
    }
    const CellGrid one({{0, 0}, {3, 0}, {3, 2}, {0, 2}}, 100);
    EXPECT_EQ(one.size(), 1u);
    EXPECT_DOUBLE_EQ(one.area(0), 6);
}

}  // namespace
