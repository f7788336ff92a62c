#include "plugin/meshlab/trackball_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include "pcm/cloud/vector.h"

namespace pcm::host {
namespace {

constexpr double half_height = 1.75, orthographic_distance = 8;

double camera_distance(float fov)
{
    constexpr double radians = pi / 180;
    return is_orthographic(fov) ? orthographic_distance : half_height / std::tan(fov * radians / 2);
}

using Rows = std::array<Vec3d, 3>;

// The rotation of a quaternion (w, x, y, z) of any length.
Rows rotation_of(const std::array<double, 4>& q)
{
    double square = 0;
    for (const double v : q) square += v * v;
    const double s = 2 / square;
    const auto [w, x, y, z] = q;
    return {{{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
             {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
             {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}}};
}

// The largest component comes from a square root of at least 1/4, the others from it.
std::array<double, 4> quaternion_of(const Rows& r)
{
    const std::array<double, 4> four_squares{1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2],
                                             1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2]};
    const auto largest =
        static_cast<std::size_t>(std::max_element(four_squares.begin(), four_squares.end()) - four_squares.begin());
    // 4 * q[i] * q[j]
    const double wx = r[2][1] - r[1][2], wy = r[0][2] - r[2][0], wz = r[1][0] - r[0][1];
    const double xy = r[0][1] + r[1][0], xz = r[0][2] + r[2][0], yz = r[1][2] + r[2][1];
    const double products[4][4] = {{four_squares[0], wx, wy, wz},
                                   {wx, four_squares[1], xy, xz},
                                   {wy, xy, four_squares[2], yz},
                                   {wz, xz, yz, four_squares[3]}};
    const double root = 2 * std::sqrt(four_squares[largest]);
    std::array<double, 4> q{};
    for (std::size_t i = 0; i < 4; ++i) q[i] = products[largest][i] / root;
    return q;
}

}  // namespace

bool is_orthographic(float fov) { return fov <= orthographic_fov; }

EyePose pose_of(const vcg::Similarityf& track, float fov)
{
    const Rows rows = rotation_of({track.rot[0], track.rot[1], track.rot[2], track.rot[3]});
    EyePose pose;
    pose.right = rows[0];
    pose.up = rows[1];
    pose.back = rows[2];
    pose.focus = camera_distance(fov) / track.sca;
    pose.orthographic = is_orthographic(fov);
    for (std::size_t a = 0; a < 3; ++a) pose.eye[a] = pose.focus * pose.back[a] - track.tra[static_cast<int>(a)];
    return pose;
}

vcg::Similarityf trackball_of(const EyePose& pose, float fov)
{
    vcg::Similarityf track;
    const auto q = quaternion_of({pose.right, pose.up, pose.back});
    for (int i = 0; i < 4; ++i) track.rot[i] = static_cast<float>(q[static_cast<std::size_t>(i)]);
    track.sca = static_cast<float>(camera_distance(fov) / pose.focus);
    // Computed with the rounded scale, so that the eye is exact.
    const double focus = camera_distance(fov) / track.sca;
    for (std::size_t a = 0; a < 3; ++a)
        track.tra[static_cast<int>(a)] = static_cast<float>(focus * pose.back[a] - pose.eye[a]);
    return track;
}

}  // namespace pcm::host
