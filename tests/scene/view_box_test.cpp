// Boxes taken from a view and from the selected vertices of a layer.
#include "plugin/scene/view_box.h"

#include "pcm/cloud/vector.h"
#include "tests/scene/fake_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace pcm;
using namespace pcm::host;

namespace {

EyePose looking(const Vec3d& eye, const Vec3d& target)
{
    EyePose pose;
    pose.eye = eye;
    pose.back = normalised(eye - target);
    pose.right = normalised(cross({0.1, 0.2, 1}, pose.back));
    pose.up = cross(pose.back, pose.right);
    pose.focus = length(eye - target);
    return pose;
}

bool is_seen(const EyePose& pose, float fov, double aspect, const Vec3d& point)
{
    const Vec3d p = point - pose.eye;
    const double depth = pose.orthographic ? 8 : -dot(pose.back, p);
    const double half =
        pose.orthographic ? 1.75 / 8 * pose.focus : depth * std::tan(static_cast<double>(fov) * pi / 360);
    return depth > 0 && std::fabs(dot(pose.right, p)) <= half * aspect && std::fabs(dot(pose.up, p)) <= half;
}

TEST(ViewBox, ClippingKeepsWhatIsSeenAndNoMore)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anywhere(-3, 3), inside(-1, 1);
    const Box3d box{{-1, -1, -1}, {1, 1, 1}};
    int partly = 0;
    for (int trial = 0; trial < 60; ++trial) {
        EyePose pose = looking({anywhere(random), anywhere(random), anywhere(random)},
                               {inside(random), inside(random), inside(random)});
        pose.orthographic = trial % 3 == 0;
        const float fov = pose.orthographic ? 5.0f : 40.0f;
        Box3d seen;
        for (int i = 0; i < 60000; ++i) {
            const Vec3d p{inside(random), inside(random), inside(random)};
            if (is_seen(pose, fov, 1.5, p)) seen.extend(p);
        }
        const Box3d found = clipped(box, seen_by(pose, fov, 1.5), pose.eye);
        if (seen.empty()) continue;
        ASSERT_TRUE(box.contains(found));
        ASSERT_TRUE(found.contains(seen)) << trial;
        for (std::size_t a = 0; a < 3; ++a) {  // corners that random points rarely reach
            EXPECT_NEAR(found.min[a], seen.min[a], 0.3) << trial;
            EXPECT_NEAR(found.max[a], seen.max[a], 0.3) << trial;
        }
        partly += !found.contains(box);
    }
    EXPECT_GT(partly, 20);
    const EyePose away = looking({3, 0, 0}, {6, 0, 0});
    EXPECT_TRUE(clipped(box, seen_by(away, 40, 1), away.eye).empty());
}

TEST(ViewBox, TextIsRoundedOutwards)
{
    EXPECT_EQ(box_text({{0.123456, -1, 5}, {11, 2.00001, 5}}), "0.123 -1.000 5.000 11.000 2.001 5.000");
    EXPECT_EQ(box_text({{685100.1234, 1e6, 0}, {686100.1239, 1000500, 30.25}}),
              "685100.1 1000000.0 0.0 686100.2 1000500.0 30.3");
    EXPECT_EQ(box_text({{1.5, 2, 3}, {1.5, 2, 3}}),
              "1.500000000 2.000000000 3.000000000 1.500000000 2.000000000 3.000000000");
}

TEST(ViewBox, SelectionIsInSourceCoordinates)
{
    FakeScene scene;
    FakeLayer& layer = scene.add("points");
    const Vec3d origin = far_away;
    EXPECT_FALSE(box_of_selection(layer));
    for (const double x : {1.0, 2.0, 9.0}) layer.vertices.push_back({{x, 2 * x, 3}, x < 5});
    const auto box = box_of_selection(layer);
    ASSERT_TRUE(box);
    for (std::size_t a = 0; a < 3; ++a) {
        const double low[] = {1, 2, 3}, high[] = {2, 4, 3};
        EXPECT_NEAR(box->min[a], low[a] + origin[a], 1e-4);
        EXPECT_NEAR(box->max[a], high[a] + origin[a], 1e-4);
        EXPECT_LE(box->min[a], low[a] + origin[a]);
        EXPECT_GE(box->max[a], high[a] + origin[a]);
    }
}

// FakeView looks straight down, 800 x 600; the layer's matrix moves the vertices before they are seen.
TEST(ViewBox, WhatAViewShowsOfALayer)
{
    FakeScene scene;
    FakeView view(scene);
    ViewPose pose;
    pose.pose.eye = {0, 0, 100};
    pose.pose.focus = 100;
    pose.fov = 60;  // 57.7 above and below the centre at the height 0
    view.look_from(pose);
    FakeLayer& layer = scene.add("points");
    for (const double x : {-90.0, -70.0, 0.0, 70.0}) layer.vertices.push_back({{x, 0, 0}, false});
    auto box = view.SceneView::seen_box(layer);
    ASSERT_TRUE(box);
    EXPECT_NEAR(box->min[0], far_away[0] - 70, 0.1);
    EXPECT_NEAR(box->max[0], far_away[0] + 70, 0.1);
    LayerMatrix moved = host::identity_matrix;
    moved[0][3] = 20;
    layer.set_matrix(moved);
    box = view.SceneView::seen_box(layer);
    ASSERT_TRUE(box);
    EXPECT_NEAR(box->min[0], far_away[0] - 90, 0.1);
    EXPECT_NEAR(box->max[0], far_away[0], 0.1);
}

}  // namespace
