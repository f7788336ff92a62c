// Where a cloud is first looked at from.
#include "pcm/view/first_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

using namespace pcm;

namespace {

const PictureShape picture{45, 800, 600, 0};

// The walls, the floor and the ceiling of a room of 8 x 6 x 3 around `at`, and a pillar in it.
std::vector<Vec3d> room(const Vec3d& at)
{
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> even(-1, 1);
    std::vector<Vec3d> points;
    const Vec3d half{4, 3, 1.5};
    for (int i = 0; i < 3000; ++i) {
        Vec3d p{half[0] * even(random), half[1] * even(random), half[2] * even(random)};
        const auto wall = static_cast<std::size_t>(i % 3);
        p[wall] = i % 2 ? half[wall] : -half[wall];
        points.push_back(at + p);
    }
    return points;
}

// What a depth camera at the origin sees of a wall at `distance` and a box before it: x to the right, y down, z ahead.
std::vector<Vec3d> depth_image(double distance)
{
    std::vector<Vec3d> points;
    for (int v = -24; v <= 24; ++v)
        for (int u = -32; u <= 32; ++u) {
            const double depth = std::abs(u) < 8 && std::abs(v) < 8 ? 0.6 * distance : distance + 0.01 * u;
            points.push_back({depth * u / 58.0, depth * v / 58.0, depth});
        }
    return points;
}

Metadata block(const std::string& key, const std::string& text)
{
    Metadata metadata{key, {}};
    for (const char c : text) metadata.value.push_back(static_cast<std::byte>(c));
    return metadata;
}

std::string ptx(const std::string& matrix) { return "320\n240\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + matrix; }

std::optional<EyePose> view(const std::vector<Vec3d>& points, const std::vector<Metadata>& metadata)
{
    return first_view(points, scan_poses(metadata), picture);
}

bool is_from_above(const EyePose& pose) { return std::abs(pose.back[2] - 0.58) < 0.01 && pose.up[2] > 0; }

double away(const Vec3d& a, const Vec3d& b) { return length(a - b); }

}  // namespace

// The picture of a depth camera is upright and seen from before the wall, whatever programs write as its orientation.
TEST(FirstView, ADepthImageIsSeenAsItsCameraSawIt)
{
    for (const char* const viewpoint : {"0 0 0 1 0 0 0", "0 0 0 0 1 0 0"}) {
        const auto pose = view(depth_image(2), {block("pcd.viewpoint", viewpoint)});
        ASSERT_TRUE(pose);
        EXPECT_LT(away(pose->eye, {0, 0, 0}), 1e-9) << viewpoint;
        EXPECT_LT(away(pose->back, {0, 0, -1}), 1e-9) << viewpoint;
        EXPECT_LT(away(pose->up, {0, -1, 0}), 1e-9) << viewpoint;
        EXPECT_LT(away(pose->right, {1, 0, 0}), 1e-9) << viewpoint;
        EXPECT_NEAR(pose->focus, 1.2, 0.01) << "the box in the middle";
    }
    // Turned and moved with the points, as PTX and E57 state it: a quarter about x, so that z is up.
    std::vector<Vec3d> placed;
    for (const Vec3d& p : depth_image(2)) placed.push_back({100 + p[0], 200 + p[2], 50 - p[1]});
    const std::string half = "0.70710678118654752";
    for (const Metadata& metadata : {block("ptx.scan/1", ptx("1 0 0 0\n0 0 -1 0\n0 1 0 0\n100 200 50 1\n")),
                                     block("e57.scan/1/pose", "100 200 50 " + half + " -" + half + " 0 0")}) {
        const auto pose = view(placed, {metadata});
        ASSERT_TRUE(pose);
        EXPECT_LT(away(pose->eye, {100, 200, 50}), 1e-9) << metadata.key;
        EXPECT_LT(away(pose->back, {0, -1, 0}), 1e-9) << metadata.key;
        EXPECT_LT(away(pose->up, {0, 0, 1}), 1e-9) << metadata.key;
    }
}

// About an axis like no other, by the formula of turning with a quaternion's vector.
TEST(FirstView, AnyTurnOfADepthCameraIsUnderstood)
{
    const double w = 0.7, size = std::sqrt(0.49 + 0.09 + 0.16 + 0.26);
    const Vec3d u = (1 / size) * Vec3d{0.3, -0.4, std::sqrt(0.26)}, eye{100, 200, 50};
    const auto turned = [&](const Vec3d& v) {
        const Vec3d across = cross(u, v);
        return v + 2 * (w / size * across + cross(u, across));
    };
    std::vector<Vec3d> placed;
    for (const Vec3d& p : depth_image(2)) placed.push_back(eye + turned(p));
    const auto pose =
        view(placed, {block("e57.scan/1/pose", "100 200 50 0.7 0.3 -0.4 " + std::to_string(std::sqrt(0.26)))});
    ASSERT_TRUE(pose);
    EXPECT_LT(away(pose->eye, eye), 1e-9);
    EXPECT_LT(away(pose->back, turned({0, 0, -1})), 1e-5);
    EXPECT_LT(away(pose->up, turned({0, -1, 0})), 1e-5);
    EXPECT_LT(away(pose->right, turned({1, 0, 0})), 1e-5);
}

// A scanner in a room looks level, into the direction of most points.
TEST(FirstView, AScanIsSeenFromItsScanner)
{
    const Vec3d at{500, 4000, 20};
    std::vector<Vec3d> points = room(at);
    for (int i = 0; i < 1500; ++i) points.push_back(at + Vec3d{-3.9, 0.002 * i - 1.5, 0.0005 * i});  // more at -x
    const auto pose = view(points, {block("e57.scan/1/pose", "500 4000 20 1 0 0 0")});
    ASSERT_TRUE(pose);
    EXPECT_LT(away(pose->eye, at), 1e-9);
    EXPECT_LT(away(pose->up, {0, 0, 1}), 1e-9);
    EXPECT_GT(pose->back[0], 0.8);
    EXPECT_NEAR(pose->focus, 4, 0.5);
}

// What was cut out of a depth image is seen from the side of its camera, and fills the picture.
TEST(FirstView, APartOfADepthImageFillsThePicture)
{
    std::vector<Vec3d> part;
    for (const Vec3d& p : depth_image(2))
        if (p[0] > 0.4 && p[1] < -0.3) part.push_back(p);
    const auto pose = view(part, {block("pcd.viewpoint", "0 0 0 1 0 0 0")});
    ASSERT_TRUE(pose);
    EXPECT_LT(away(pose->back, {0, 0, -1}), 1e-9);
    EXPECT_LT(away(pose->up, {0, -1, 0}), 1e-9);
    EXPECT_GT(pose->eye[2], 0.5);
    EXPECT_NEAR(pose->eye[0], 0.75, 0.1);
}

TEST(FirstView, WhereNoScanWasTakenFromOneIsFromAbove)
{
    const Vec3d at{500, 4000, 20};
    const auto expect_above = [&](const std::vector<Vec3d>& points, const std::vector<Metadata>& metadata,
                                  const char* what) {
        const auto pose = view(points, metadata);
        ASSERT_TRUE(pose) << what;
        EXPECT_TRUE(is_from_above(*pose)) << what;
    };
    const Metadata scan = block("ptx.scan/1", ptx("1 0 0 0\n0 1 0 0\n0 0 1 0\n500 4000 20 1\n"));
    EXPECT_FALSE(is_from_above(*view(room(at), {scan})));
    expect_above(room(at), {}, "no metadata");
    expect_above(room(at), {scan, block("ptx.scan/2", ptx("1 0 0 0\n0 1 0 0\n0 0 1 0\n500 4000 20 1\n"))}, "two scans");
    expect_above(room(at), {block("pcd.viewpoint", "0 0 0 1 0 0 0")}, "the viewpoint of writers that know of none");
    expect_above(room({0, 0, 0}), {block("pcd.viewpoint", "0 0 0 1 0 0 0")}, "all around an unstated viewpoint");
    expect_above(room(at), {block("pcd.viewpoint", "0 0 nan 1 0 0 0")}, "not a number");
    expect_above(room(at), {block("ptx.scan/1", "320\n240\n0 0 0\n")}, "cut off");
    expect_above(room(at), {block("e57.scan/1/pose", "489 4001 20 1 0 0 0")},
                 "moved away: it would see walls behind walls");
    // Two layers in front of a camera.
    std::vector<Vec3d> layers = depth_image(2);
    for (const Vec3d& p : depth_image(3.3)) layers.push_back(p);
    expect_above(layers, {block("pcd.viewpoint", "0 0 0 1 0 0 0")}, "two layers");
}

// One point in a hundred, however far away it is.
TEST(FirstView, NoiseFarAwayDoesNotPushTheCameraAway)
{
    std::vector<Vec3d> points = room({0, 0, 0});
    const auto alone = view(points, {});
    std::mt19937_64 random(8);
    std::normal_distribution<double> wide(0, 1e4);
    const std::size_t noise = points.size() / 100;
    for (std::size_t i = 0; i < noise; ++i) points.push_back({wide(random), wide(random), wide(random)});
    const auto noisy = view(points, {});
    ASSERT_TRUE(alone && noisy);
    EXPECT_LT(away(noisy->eye, alone->eye), 0.1 * length(alone->eye));
}

// The same picture at map coordinates, and of any unit.
TEST(FirstView, WhereverACloudIsAndHoweverLarge)
{
    const std::vector<Vec3d> points = room({0, 0, 0});
    const auto usual = view(points, {});
    for (const double unit : {1e-30, 1e-3, 1.0, 1e25})
        for (const Vec3d& at : {Vec3d{0, 0, 0}, Vec3d{5e5 * unit, 5e6 * unit, 100 * unit}}) {
            std::vector<Vec3d> moved;
            for (const Vec3d& p : points) moved.push_back(at + unit * p);
            const auto pose = view(moved, {});
            ASSERT_TRUE(pose);
            EXPECT_LT(away((1 / unit) * (pose->eye - at), usual->eye), 1e-4) << unit;
        }
}

TEST(FirstView, OfAnySmallCloud)
{
    EXPECT_FALSE(view({}, {}));
    for (const auto& points :
         std::vector<std::vector<Vec3d>>{{{1, 2, 3}}, {{0, 0, 0}, {0, 0, 9}}, {{1e6, 1e6, 0}, {1e6, 1e6, 0}}}) {
        const auto pose = view(points, {block("pcd.viewpoint", "0 0 0 1 0 0 0")});
        ASSERT_TRUE(pose);
        EXPECT_TRUE(std::isfinite(length(pose->eye)) && pose->focus > 0);
    }
}
