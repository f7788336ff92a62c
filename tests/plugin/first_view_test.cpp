// The view in which a cloud is opened, as MeshLab's trackball keeps it.
#include "pcm/view/first_view.h"

#include "pcm/cloud/vector.h"
#include "plugin/meshlab/trackball_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace pcm;
using namespace pcm::host;

namespace {

constexpr float fov = 60;

std::optional<vcg::Similarityf> first_view(const std::vector<Vec3d>& points, float degrees, int width, int height,
                                           int covered = 0)
{
    const auto pose = pcm::first_view(points, {}, {static_cast<double>(degrees), width, height, covered});
    return pose ? std::optional(trackball_of(*pose, degrees)) : std::nullopt;
}

// A hilly square of 400 x 400 units.
std::vector<Vec3d> hills(const Vec3d& at)
{
    std::vector<Vec3d> points;
    for (int i = -50; i <= 50; ++i)
        for (int j = -50; j <= 50; ++j) points.push_back(at + Vec3d{4.0 * i, 4.0 * j, 10 * std::sin(0.2 * i)});
    return points;
}

// Where points are in the picture, which is from -1 to 1; of each side without one point in 500.
struct Seen {
    double left = 0, right = 0, bottom = 0, top = 0;
    std::size_t outside = 0;
};

Seen seen(const std::vector<Vec3d>& points, const vcg::Similarityf& track, int width, int height)
{
    const EyePose pose = pose_of(track, fov);
    const double slope = std::tan(static_cast<double>(fov) * pi / 360);
    Seen result;
    std::vector<double> x, y;
    for (const Vec3d& point : points) {
        const Vec3d p = point - pose.eye;
        const double depth = -dot(pose.back, p);
        x.push_back(dot(pose.right, p) / (depth * slope * width / height));
        y.push_back(dot(pose.up, p) / (depth * slope));
        result.outside += depth <= 0 || std::fabs(x.back()) > 1 || std::fabs(y.back()) > 1;
    }
    std::sort(x.begin(), x.end());
    std::sort(y.begin(), y.end());
    const std::size_t few = points.size() / 500, last = points.size() - 1 - few;
    result.left = x[few];
    result.right = x[last];
    result.bottom = y[few];
    result.top = y[last];
    return result;
}

TEST(FirstView, FillsTheViewObliquelyFromAbove)
{
    for (const auto& [width, height] : {std::pair(800, 600), std::pair(500, 900), std::pair(1600, 300)}) {
        const auto points = hills({30, -20, 5});
        const auto view = first_view(points, fov, width, height);
        ASSERT_TRUE(view);
        const EyePose pose = pose_of(*view, fov);
        EXPECT_NEAR(pose.back[2], 0.58, 0.01);
        EXPECT_NEAR(pose.right[2], 0, 1e-6) << "the horizon is level";
        const Seen all = seen(points, *view, width, height);
        EXPECT_LE(all.outside, points.size() / 500);
        EXPECT_NEAR(std::max(all.right - all.left, all.top - all.bottom) / 2, 0.85, 0.01);
        EXPECT_NEAR(all.left + all.right, 0, 0.01);
        EXPECT_NEAR(all.bottom + all.top, 0, 0.01);
    }
}

TEST(FirstView, LeavesTheCoveredPartFree)
{
    const auto points = hills({0, 0, 0});
    for (const int width : {500, 1600}) {
        const auto view = first_view(points, fov, width, 800, 200);
        ASSERT_TRUE(view);
        const Seen all = seen(points, *view, width, 800);
        EXPECT_GT(all.bottom, -0.5);
        // The free part is from -0.5 to 1, which is 0.75 as high as the picture.
        EXPECT_NEAR(all.bottom + all.top, 0.5, 0.01);
        EXPECT_NEAR(std::max((all.right - all.left) / 2, (all.top - all.bottom) / 1.5), 0.85, 0.01);
    }
}

TEST(FirstView, TurnsAboutWhatIsSeenInTheCentre)
{
    const auto view = first_view(hills({0, 0, 0}), fov, 800, 600);
    ASSERT_TRUE(view);
    EXPECT_NEAR(pose_of(*view, fov).centre()[2], 0, 15);
}

TEST(FirstView, FewPointsFarAwayDoNotMakeTheCloudSmall)
{
    auto points = hills({0, 0, 0});
    const auto alone = first_view(points, fov, 800, 600);
    for (int i = 0; i < 10; ++i) points.push_back({1e4 * i, 2e4, -3e4});
    const auto with_birds = first_view(points, fov, 800, 600);
    ASSERT_TRUE(alone && with_birds);
    EXPECT_NEAR(with_birds->sca / alone->sca, 1, 0.1);
}

TEST(FirstView, AnyCloudHasOne)
{
    EXPECT_FALSE(first_view({}, fov, 800, 600));
    EXPECT_FALSE(first_view(hills({0, 0, 0}), fov, 0, 600));
    const std::vector<std::vector<Vec3d>> clouds{
        {{1, 2, 3}}, {{0, 0, 0}}, {{0, 0, 0}, {0, 0, 9}}, {{-7, 0, 0}, {7, 0, 0}}, {{1e6, 1e6, 0}, {1e6, 1e6, 0}}};
    for (const auto& points : clouds) {
        const auto view = first_view(points, fov, 800, 600);
        ASSERT_TRUE(view);
        EXPECT_TRUE(std::isfinite(view->sca) && view->sca > 0);
        EXPECT_EQ(seen(points, *view, 800, 600).outside, 0u);
    }
}

}  // namespace
