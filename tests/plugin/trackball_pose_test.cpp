// Conversion between MeshLab's camera and a pose, checked against MeshLab's own matrices.
#include "plugin/meshlab/trackball_pose.h"

#include <gtest/gtest.h>
#include "pcm/cloud/vector.h"

#include <vcg/math/matrix44.h>

#include <cmath>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::host;

vcg::Similarityf random_track(std::mt19937_64& random)
{
    std::normal_distribution<float> normal;
    vcg::Similarityf track;
    track.rot = vcg::Quaternionf(normal(random), normal(random), normal(random), normal(random));
    track.rot.Normalize();
    track.sca = std::exp(normal(random) * 2);
    track.tra = vcg::Point3f(normal(random), normal(random), normal(random)) * 100;
    return track;
}

// A point of the scene in eye space, by MeshLab's matrices (glarea.cpp, trackball.cpp) in double.
Vec3d seen_by_meshlab(const vcg::Similarityf& track, float fov, const Vec3d& p)
{
    vcg::Quaterniond rot(track.rot[0], track.rot[1], track.rot[2], track.rot[3]);
    rot.Normalize();
    const vcg::Point3d moved(p[0] + track.tra[0], p[1] + track.tra[1], p[2] + track.tra[2]);
    const vcg::Point3d q = rot.Rotate(moved) * double(track.sca);
    const double distance = fov <= 5 ? 8 : 1.75 / std::tan(fov * pi / 360);
    return {q[0], q[1], q[2] - distance};
}

Vec3d seen_by(const EyePose& pose, const Vec3d& p)
{
    Vec3d seen{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double d = p[a] - pose.eye[a];
        seen[0] += pose.right[a] * d;
        seen[1] += pose.up[a] * d;
        seen[2] += pose.back[a] * d;
    }
    return seen;
}

TEST(TrackballPose, IsWhatMeshLabShows)
{
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 500; ++i) {
        const vcg::Similarityf track = random_track(random);
        const float fov = i % 3 == 0 ? 5.f : 6.f + float(i % 80);
        const EyePose pose = pose_of(track, fov);
        EXPECT_EQ(pose.orthographic, fov == 5.f);
        for (int k = 0; k < 5; ++k) {
            const Vec3d p{normal(random) * 100, normal(random) * 100, normal(random) * 100};
            const Vec3d meshlab = seen_by_meshlab(track, fov, p), ours = seen_by(pose, p);
            for (std::size_t a = 0; a < 3; ++a)
                EXPECT_NEAR(ours[a] * double(track.sca), meshlab[a], 1e-9 * (1 + 1000 * double(track.sca)));
        }
        // And back: the same camera to single precision.
        const vcg::Similarityf again = trackball_of(pose, fov);
        EXPECT_NEAR(again.sca / track.sca, 1, 1e-6);
        const float sign = again.rot[0] * track.rot[0] + again.rot[1] * track.rot[1] + again.rot[2] * track.rot[2] +
                           again.rot[3] * track.rot[3];
        EXPECT_NEAR(std::fabs(sign), 1, 1e-6);
        const EyePose twice = pose_of(again, fov);
        for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(twice.eye[a], pose.eye[a], 1e-6 * (500 + pose.focus));
    }
}

// The scale is free in a perspective view: another focus gives another trackball and the same picture.
TEST(TrackballPose, FocusChangesNothingThatIsSeen)
{
    std::mt19937_64 random(2);
    for (int i = 0; i < 200; ++i) {
        EyePose pose = pose_of(random_track(random), 60);
        const EyePose before = pose;
        pose.focus *= 0.01;
        const EyePose after = pose_of(trackball_of(pose, 60), 60);
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_NEAR(after.eye[a], before.eye[a], 1e-6 * (500 + before.focus));
            EXPECT_NEAR(after.right[a], before.right[a], 1e-6);
            EXPECT_NEAR(after.back[a], before.back[a], 1e-6);
        }
        EXPECT_NEAR(after.focus / before.focus, 0.01, 1e-8);
    }
}

// Half turns, where a quaternion's real part is 0.
TEST(TrackballPose, HalfTurns)
{
    for (int axis = 0; axis < 3; ++axis) {
        vcg::Similarityf track;
        track.SetIdentity();
        track.rot = vcg::Quaternionf(0, axis == 0, axis == 1, axis == 2);
        const vcg::Similarityf again = trackball_of(pose_of(track, 60), 60);
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(std::fabs(again.rot[i]), std::fabs(track.rot[i]), 1e-6);
    }
}

}  // namespace
