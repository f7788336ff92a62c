// An eye that walks: nothing jumps when it takes over a camera, the horizon is levelled, and where it ends does not
// depend on the number of steps.
#include "pcm/view/first_person.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace pcm;

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance)
{
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

void expect_near(const EyePose& a, const EyePose& b, double tolerance)
{
    expect_near(a.eye, b.eye, tolerance);
    expect_near(a.right, b.right, tolerance);
    expect_near(a.up, b.up, tolerance);
    expect_near(a.back, b.back, tolerance);
    EXPECT_NEAR(a.focus, b.focus, tolerance);
    EXPECT_EQ(a.orthographic, b.orthographic);
}

// From a unit quaternion, like a trackball's.
EyePose random_pose(std::mt19937_64& random)
{
    std::normal_distribution<double> normal;
    double q[4], length = 0;
    for (double& v : q) v = normal(random), length += v * v;
    for (double& v : q) v /= std::sqrt(length);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    EyePose pose;
    pose.eye = {normal(random) * 100, normal(random) * 100, normal(random) * 100};
    pose.right = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
    pose.up = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
    pose.back = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
    pose.focus = std::exp(normal(random));
    return pose;
}

TEST(FirstPerson, TakesOverAnyCameraAsItIs)
{
    std::mt19937_64 random(1);
    for (int i = 0; i < 2000; ++i) {
        EyePose pose = random_pose(random);
        pose.orthographic = i % 3 == 0;
        for (const UpAxis axis : {UpAxis::y, UpAxis::z}) {
            FirstPerson walk(pose, axis);
            expect_near(walk.pose(), pose, 1e-12);
            EXPECT_FALSE(walk.moves(0));
            EXPECT_FALSE(walk.step(1, 0, 5));
            expect_near(walk.pose(), pose, 1e-12);
            walk.set_up_axis(axis == UpAxis::y ? UpAxis::z : UpAxis::y);
            expect_near(walk.pose(), pose, 1e-12);
        }
    }
}

TEST(FirstPerson, StraightDownNeedsNoRoll)
{
    for (const double angle : {0.0, 0.4, 2.0, -3.0}) {
        for (const double sign : {1.0, -1.0}) {
            EyePose pose;  // pose in a map: z up, north turned by the angle
            pose.right = {std::cos(angle), std::sin(angle), 0};
            pose.up = {-std::sin(angle) * sign, std::cos(angle) * sign, 0};
            pose.back = {0, 0, sign};
            FirstPerson walk(pose, UpAxis::z);
            expect_near(walk.pose(), pose, 1e-15);
            EXPECT_EQ(walk.roll(), 0);
            EXPECT_DOUBLE_EQ(walk.pitch(), -sign * pi / 2);
            EXPECT_NEAR(std::remainder(walk.yaw() - angle, 2 * pi), 0, 1e-12);
            // And from there up to the horizon, without turning aside.
            walk.turn(0, sign * pi / 2);
            expect_near(walk.pose().right, pose.right, 1e-12);
            EXPECT_NEAR(walk.pose().back[2], 0, 1e-12);
        }
    }
}

TEST(FirstPerson, HorizonIsLevelledWhenTheEyeMoves)
{
    std::mt19937_64 random(2);
    for (int i = 0; i < 200; ++i) {
        const EyePose pose = random_pose(random);
        FirstPerson walk(pose, UpAxis::z);
        const double roll = walk.roll();
        ASSERT_NE(roll, 0);
        walk.turn(0.1, 0);
        EXPECT_EQ(walk.roll(), roll);  // not at once
        double seconds = 0, last = std::fabs(roll);
        while (walk.moves(0)) {
            ASSERT_TRUE(walk.step(0.01, 0, 1));
            EXPECT_LT(std::fabs(walk.roll()), last);
            last = std::fabs(walk.roll());
            ASSERT_LT(seconds += 0.01, 5);
        }
        const EyePose level = walk.pose();
        EXPECT_EQ(walk.roll(), 0);
        EXPECT_NEAR(level.right[2], 0, 1e-12);
        EXPECT_GE(level.up[2], -1e-12);
        expect_near(level.eye, pose.eye, 0);
        // Still right-handed unit axes.
        EXPECT_NEAR(dot(level.right, level.up), 0, 1e-12);
        EXPECT_NEAR(dot(level.back, level.up), 0, 1e-12);
        EXPECT_NEAR(dot(level.right, level.right), 1, 1e-12);

        for (const unsigned key : {walk_forward, walk_left, walk_up}) {  // one step starts it, too
            FirstPerson walker(pose, UpAxis::z);
            ASSERT_FALSE(walker.step(0.01, 0, 1));
            ASSERT_TRUE(walker.step(0.01, key, 1));
            ASSERT_NEAR(walker.roll(), roll * std::exp(-0.01 / 0.15), 1e-12);
            for (int step = 0; walker.moves(0) && step < 500; ++step) walker.step(0.01, 0, 1);
            EXPECT_EQ(walker.roll(), 0);
        }
    }
}

TEST(FirstPerson, Turns)
{
    EyePose pose;  // looks along -z, y up
    FirstPerson walk(pose, UpAxis::y);
    EXPECT_EQ(walk.yaw(), 0);
    walk.turn(pi / 2, 0);  // to the left, along -x
    expect_near(walk.pose().back, {1, 0, 0}, 1e-15);
    walk.turn(-pi, 0);
    expect_near(walk.pose().back, {-1, 0, 0}, 1e-15);
    walk.turn(0, pi / 4);  // upwards
    EXPECT_LT(walk.pose().back[1], 0);
    walk.turn(0, 10);
    EXPECT_DOUBLE_EQ(walk.pitch(), pi / 2);
    walk.turn(0, -10);
    EXPECT_DOUBLE_EQ(walk.pitch(), -pi / 2);
    walk.turn(std::numeric_limits<double>::quiet_NaN(), 0);
    walk.turn(0, std::numeric_limits<double>::infinity());
    EXPECT_DOUBLE_EQ(walk.pitch(), -pi / 2);
    expect_near(walk.pose().eye, {0, 0, 0}, 0);
}

TEST(FirstPerson, WalksBySpeedAndTime)
{
    EyePose pose;
    FirstPerson walk(pose, UpAxis::y);
    EXPECT_TRUE(walk.step(0.5, walk_forward, 10));
    expect_near(walk.pose().eye, {0, 0, -5}, 1e-12);
    EXPECT_EQ(walk.pose().focus, 10);
    EXPECT_TRUE(walk.step(0.5, walk_right, 10));
    expect_near(walk.pose().eye, {5, 0, -5}, 1e-12);
    EXPECT_TRUE(walk.step(0.25, walk_up | walk_fast, 10));
    expect_near(walk.pose().eye, {5, 10, -5}, 1e-12);
    EXPECT_TRUE(walk.step(1, walk_back | walk_left | walk_down, 3));
    const double each = 3 / std::sqrt(3.0);
    expect_near(walk.pose().eye, {5 - each, 10 - each, -5 + each}, 1e-12);
    const EyePose stood = walk.pose();
    // Opposite keys, no direction, no time, no reach.
    EXPECT_FALSE(walk.step(1, walk_left | walk_right | walk_fast, 3));
    EXPECT_FALSE(walk.step(1, walk_fast, 3));
    EXPECT_FALSE(walk.step(0, walk_left, 3));
    EXPECT_FALSE(walk.step(std::numeric_limits<double>::quiet_NaN(), walk_left, 3));
    walk.step(1, walk_left, 0);
    walk.step(1, walk_left, std::numeric_limits<double>::infinity());
    expect_near(walk.pose(), stood, 0);

    walk.change_speed(3);
    EXPECT_DOUBLE_EQ(walk.factor(), std::pow(FirstPerson::wheel_factor, 3));
    walk.change_speed(1000);
    EXPECT_EQ(walk.factor(), FirstPerson::most_factor);
    walk.change_speed(-5000);
    EXPECT_EQ(walk.factor(), FirstPerson::least_factor);
    walk.step(1, walk_right, 64);
    expect_near(walk.pose().eye, {stood.eye[0] + 1, stood.eye[1], stood.eye[2]}, 1e-12);
}

TEST(FirstPerson, ManyStepsAreOneLongStep)
{
    std::mt19937_64 random(3);
    std::uniform_int_distribution<unsigned> any(0, 127);
    for (int i = 0; i < 400; ++i) {
        EyePose pose = random_pose(random);
        pose.orthographic = i % 2 == 0;
        const unsigned keys = any(random);
        FirstPerson one(pose, UpAxis::z), many(pose, UpAxis::z);
        one.step(0.5, keys, 2);
        for (int k = 0; k < 50; ++k) many.step(0.01, keys, 2);
        if (many.roll() == 0) continue;  // levelling ends early once the roll is small
        expect_near(one.pose(), many.pose(), 1e-9 * (1 + std::exp(2.0) * pose.focus));
    }
}

TEST(FirstPerson, OrthographicViewsZoomAndTurnAboutTheirCentre)
{
    EyePose pose;
    pose.focus = 8;
    pose.orthographic = true;
    FirstPerson walk(pose, UpAxis::y);
    const Vec3d centre = pose.centre();
    walk.step(1, walk_forward, 123);  // the reach has no effect here
    EXPECT_NEAR(walk.pose().focus, 8 / std::exp(1.0), 1e-12);
    expect_near(walk.pose().centre(), centre, 1e-12);
    walk.step(1, walk_back, 123);
    expect_near(walk.pose(), pose, 1e-12);
    walk.turn(1, 0.5);
    expect_near(walk.pose().centre(), centre, 1e-12);
    EXPECT_NEAR(walk.pose().focus, 8, 0);
    walk.turn(-1, -0.5);
    walk.step(0.5, walk_right, 123);
    expect_near(walk.pose().centre(), {4, 0, -8}, 1e-12);
    EXPECT_EQ(walk.pose().focus, 8);
    for (int i = 0; i < 100; ++i) walk.step(100, walk_forward, 1);
    EXPECT_GT(walk.pose().focus, 0);  // never through zero
    for (int i = 0; i < 100; ++i) walk.step(100, walk_back, 1);
    EXPECT_TRUE(std::isfinite(walk.pose().focus));
}

TEST(FirstPerson, RefusesInvalidPoses)
{
    const auto refused = [](const EyePose& pose) {
        try {
            FirstPerson walk(pose, UpAxis::z);
        } catch (const Error& error) {
            return error.code() == ErrorCode::invalid_argument;
        }
        return false;
    };
    EyePose pose;
    EXPECT_FALSE(refused(pose));
    pose.eye[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(refused(pose));
    pose = {};
    pose.back = {0, 0, -1};  // left-handed
    EXPECT_TRUE(refused(pose));
    pose = {};
    pose.up = {0, 0, 0};
    EXPECT_TRUE(refused(pose));
    pose = {};
    pose.up = {0.6, 0.8, 0};
    EXPECT_TRUE(refused(pose));
    for (const double focus :
         {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        pose = {};
        pose.focus = focus;
        EXPECT_TRUE(refused(pose)) << focus;
    }
    // Unit axes in single precision are accepted.
    std::mt19937_64 random(4);
    EyePose rounded = random_pose(random);
    for (Vec3d* axis : {&rounded.right, &rounded.up, &rounded.back})
        for (double& v : *axis) v = double(float(v));
    FirstPerson walk(rounded, UpAxis::z);
    EXPECT_NEAR(dot(walk.pose().right, walk.pose().up), 0, 1e-15);
    expect_near(walk.pose(), rounded, 3e-7);
}

}  // namespace
