// The area of outlines against surfaces whose area is known.
#include "pcm/shapes/outline_area.h"

#include "pcm/shapes/bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace {

using namespace pcm;

std::vector<Vec3d> moved(std::vector<Vec3d> corners)
{
    // A slanted plane at map coordinates.
    const Vec3d u = normalised(Vec3d{1, 0.2, 0.4}), v = normalised(cross(normalised(Vec3d{-0.4, 0.1, 1}), u));
    for (Vec3d& p : corners) p = Vec3d{500000, 4800000, 300} + p[0] * u + p[1] * v;
    return corners;
}

TEST(OutlineArea, SaysWhatItIsOf)
{
    const std::vector<Vec3d> rectangle{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}};
    EXPECT_EQ(outline_area(rectangle, 100).form, OutlineForm::rectangle);
    EXPECT_DOUBLE_EQ(outline_area(rectangle, 100).area, 12);
    EXPECT_EQ(outline_area(rectangle, 100).uncertainty, 0);
    EXPECT_EQ(outline_area(moved(rectangle), 0).form, OutlineForm::rectangle);
    const std::vector<Vec3d> convex{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {1, 3, 0}};
    const OutlineArea trapezium = outline_area(moved(convex), 1050);
    EXPECT_EQ(trapezium.form, OutlineForm::convex);
    EXPECT_NEAR(trapezium.area, 10.5, 1e-8);
    EXPECT_NEAR(trapezium.uncertainty, (4 + 3 + 3 + std::sqrt(10.0)) * 0.1 / 2, 1e-8);
    for (const bool turned : {false, true}) {
        std::vector<Vec3d> corner{{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
        if (turned) std::reverse(corner.begin(), corner.end());
        EXPECT_EQ(outline_area(moved(corner), 0).form, OutlineForm::concave);
        EXPECT_NEAR(outline_area(moved(corner), 0).area, 6, 1e-8);
        EXPECT_EQ(outline_area(moved(corner), 0).uncertainty, 0);
    }
    EXPECT_EQ(outline_area({}, 5).form, OutlineForm::none);
    EXPECT_EQ(words_of(OutlineForm::rectangle), "in the rectangle around its points");
    EXPECT_EQ(words_of(OutlineForm::none), "");
}

// Roofs with an angle: the rectangle is half as large again, the outline is right within its uncertainty.
TEST(OutlineArea, OfPointsIsThatOfTheirSurface)
{
    std::mt19937_64 random(4);
    int within = 0, rounds = 0;
    for (const std::size_t count : {60u, 150u, 600u, 5000u})
        for (int round = 0; round < 12; ++round) {
            std::uniform_real_distribution<double> unit(0, 10);
            std::vector<Vec3d> points;
            while (points.size() < count) {
                const double x = unit(random), y = unit(random);
                if (x < 4 || y < 4) points.push_back({x, y, 0});
            }
            constexpr double truth = 64;
            Shape plane;
            plane.kind = ShapeKind::plane;
            plane.point = {5, 5, 0};
            plane.axis = {0, 0, 1};
            OutlineOptions options;
            options.kind = OutlineKind::concave;
            const OutlineArea found = outline_area(bounds_of(plane, points, options).outline, count);
            EXPECT_EQ(found.form, OutlineForm::concave);
            EXPECT_NEAR(found.area, truth, 3 * found.uncertainty) << count;
            EXPECT_LT(found.uncertainty, 6 * 40 * std::sqrt(truth / static_cast<double>(count)) / 2 / 4);
            within += std::fabs(found.area - truth) <= found.uncertainty;
            ++rounds;
            options.kind = OutlineKind::rectangle;
            const OutlineArea around = outline_area(bounds_of(plane, points, options).outline, count);
            EXPECT_EQ(around.form, OutlineForm::rectangle);
            EXPECT_GT(around.area, 1.2 * truth);
        }
    EXPECT_GE(within, 2 * rounds / 3);
}

}  // namespace
