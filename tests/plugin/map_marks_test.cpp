// The scale bar, the arrow to north and the grid of coordinates.
#include "plugin/overlay/map_marks.h"

#include "pcm/cloud/vector.h"
#include "pcm/view/screen_map.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace pcm;
using namespace pcm::host;

namespace {

// Straight down on a place, `half` units from the centre to each border of 800 x 800 pixels; `up` is turned
// counter-clockwise by an angle, and the view tilted by another.
Camera plan(const Vec3d& centre, double half, double turn = 0, double tilt = 0)
{
    Camera camera;
    camera.width = camera.height = 800;
    camera.origin = centre;
    const double c = std::cos(turn), s = std::sin(turn), ct = std::cos(tilt), st = std::sin(tilt);
    // First the turn about z, then the tilt about x.
    camera.modelview = {c, ct * s, st * s, 0, -s, ct * c, st * c, 0, 0, -st, ct, 0, 0, 0, -10 * half, 1};
    camera.projection = {1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / (99 * half), 0, 0, 0, -101.0 / 99, 1};
    return camera;
}

TEST(MapMarks, RoundLengths)
{
    for (const auto& [most, expected] : std::vector<std::pair<double, double>>{{1, 1},
                                                                               {1.99, 1},
                                                                               {2, 2},
                                                                               {4.9, 2},
                                                                               {5, 5},
                                                                               {9.99, 5},
                                                                               {10, 10},
                                                                               {0.003, 0.002},
                                                                               {1e9, 1e9},
                                                                               {7e-9, 5e-9}})
        EXPECT_NEAR(round_length(most) / expected, 1, 1e-12) << most;
    EXPECT_EQ(step_text(5000200, 50), "5000200");
    EXPECT_EQ(step_text(0.30000000000000004, 0.1), "0.3");
    EXPECT_EQ(step_text(500000.05, 0.05), "500000.05");
    EXPECT_EQ(step_text(-0.0001, 0.5), "0.0");
}

TEST(MapMarks, TheScaleBarIsAsLongAsItSays)
{
    // Orthographic: 0.25 units a pixel, at any depth.
    const auto bar = scale_bar(plan({5e5, 5e6, 0}, 100), 8, 160);
    ASSERT_TRUE(bar);
    EXPECT_DOUBLE_EQ(bar->length, 20);
    EXPECT_NEAR(bar->pixels, 80, 1e-9);
    // Perspective, and a modelview that scales by 3: at a depth of 12 eye units, 4 source units.
    Camera camera;
    camera.width = camera.height = 800;
    camera.modelview = {3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, -12, 1};
    camera.projection = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1.002, -1, 0, 0, -0.2, 0};
    const auto seen = scale_bar(camera, 12, 160);
    ASSERT_TRUE(seen);
    EXPECT_DOUBLE_EQ(seen->length, 1);
    const auto map = ScreenMap::of(camera);
    ASSERT_TRUE(map);
    EXPECT_NEAR((*map->place_of({1, 0, 0}))[0] - (*map->place_of({0, 0, 0}))[0], seen->pixels, 1e-9);
    EXPECT_FALSE(scale_bar(Camera{}, 8, 160));
}

TEST(MapMarks, NorthIsWhereYPoints)
{
    for (const double turn : {0.0, 0.5, 3.0}) {
        const auto arrow = north(plan({5e5, 5e6, 0}, 100, turn));
        ASSERT_TRUE(arrow);
        EXPECT_NEAR((*arrow)[0], -std::sin(turn), 1e-12);
        EXPECT_NEAR((*arrow)[1], std::cos(turn), 1e-12);
    }
    const auto oblique = north(plan({0, 0, 0}, 100, 0, -pi / 3));
    ASSERT_TRUE(oblique);
    EXPECT_NEAR((*oblique)[1], 0.5, 1e-12);
    EXPECT_FALSE(north(plan({0, 0, 0}, 100, 0, -pi / 2))) << "seen along y";
}

TEST(MapMarks, TheGridHasRoundCoordinatesAtMapOffsets)
{
    // 0.25 units a pixel: lines 100 pixels apart or more are 50 units apart.
    const Camera camera = plan({500010, 5000020, 130}, 100);
    const auto grid = plan_grid(camera, 1000, 100);
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->step, 50);
    std::vector<QString> texts;
    const auto map = ScreenMap::of(camera);
    for (const auto& [text, place] : grid->labels) texts.push_back(text);
    EXPECT_EQ(texts, (std::vector<QString>{"x 499950", "x 500000", "x 500050", "x 500100", "y 4999950", "y 5000000",
                                           "y 5000050", "y 5000100"}));
    for (std::size_t i = 0; i < grid->lines.size(); ++i) {
        const std::size_t axis = i < 4 ? 0 : 1;
        const double value = std::round(grid->lines[i][0][axis]);
        EXPECT_EQ(grid->lines[i][0][axis], value) << "exact";
        EXPECT_EQ(grid->lines[i][1][axis], value);
        // The label is at the line's end, at the upper border or the left one.
        const Vec3d end = map->source_of({grid->labels[i].second.x(), grid->labels[i].second.y(), 0});
        EXPECT_NEAR(end[axis], value, 1e-6);
        EXPECT_NEAR(axis == 0 ? grid->labels[i].second.y() : grid->labels[i].second.x(), axis == 0 ? 800 : 0, 1e-6);
    }
}

TEST(MapMarks, TheGridIsForPlanViews)
{
    EXPECT_TRUE(plan_grid(plan({5e5, 5e6, 0}, 100, 1), 8, 100));
    EXPECT_TRUE(plan_grid(plan({5e5, 5e6, 0}, 100, 1, 0.03), 8, 100));
    EXPECT_FALSE(plan_grid(plan({5e5, 5e6, 0}, 100, 0, 0.1), 8, 100)) << "tilted";
    EXPECT_FALSE(plan_grid(plan({5e5, 5e6, 0}, 100, 0, pi), 8, 100)) << "from below";
    Camera camera = plan({5e5, 5e6, 0}, 100);
    camera.projection = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1.002, -1, 0, 0, -0.2, 0};
    EXPECT_FALSE(plan_grid(camera, 8, 100)) << "perspective";
    // Steps are at least as far apart as asked for, and at most 2.5 times as far.
    for (double half = 1e-4; half < 1e7; half *= 1.7) {
        const auto grid = plan_grid(plan({5e5, 5e6, 0}, half), 8, 100);
        ASSERT_TRUE(grid) << half;
        const double pixels = grid->step / (2 * half / 800);
        EXPECT_GE(pixels, 100 * (1 - 1e-9));
        EXPECT_LE(pixels, 250 * (1 + 1e-9));
    }
}

}  // namespace
