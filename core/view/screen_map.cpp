#include "pcm/view/screen_map.h"

#include "pcm/view/frustum.h"

#include <algorithm>
#include <cmath>

namespace pcm {

std::optional<ScreenMap> ScreenMap::of(const Camera& camera)
{
    const auto frustum = Frustum::of(camera);
    if (!frustum) return std::nullopt;
    ScreenMap map;
    map.camera_ = camera;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) map.linear_[r][c] = camera.modelview[c * 4 + r] / camera.modelview[15];
    map.eye_ = frustum->local_eye();
    map.orthographic_ = frustum->orthographic();
    map.scale_ = length({map.linear_[0][0], map.linear_[1][0], map.linear_[2][0]});
    return map;
}

Vec3d ScreenMap::eye_of(const Vec3d& source) const
{
    const Vec3d away = (source - camera_.origin) - eye_;
    return {dot(linear_[0], away), dot(linear_[1], away), dot(linear_[2], away)};
}

ScreenMap::Vec4d ScreenMap::clip_of(const Vec3d& eye) const
{
    const Matrix4d& p = camera_.projection;
    Vec4d clip{};
    for (std::size_t r = 0; r < 4; ++r) clip[r] = p[r] * eye[0] + p[4 + r] * eye[1] + p[8 + r] * eye[2] + p[12 + r];
    return clip;
}

Vec3d ScreenMap::window_of(const Vec3d& eye) const
{
    const Vec4d clip = clip_of(eye);
    return {(clip[0] / clip[3] + 1) / 2 * camera_.width, (clip[1] / clip[3] + 1) / 2 * camera_.height,
            clip[2] / clip[3]};
}

std::optional<Vec3d> ScreenMap::place_of(const Vec3d& source) const
{
    const Vec3d eye = eye_of(source);
    const Vec4d clip = clip_of(eye);
    if (!is_finite(eye) || !(clip[3] > 0) || !(clip[2] >= -clip[3])) return std::nullopt;
    return window_of(eye);
}

Vec3d ScreenMap::source_of(const Vec3d& window) const
{
    // The depth along the axis follows from z and w, which depend on it alone.
    const Matrix4d& p = camera_.projection;
    const double x = 2 * window[0] / camera_.width - 1, y = 2 * window[1] / camera_.height - 1, z = window[2];
    Vec3d eye{};
    eye[2] = (z * p[15] - p[14]) / (p[10] - z * p[11]);
    const double w = p[11] * eye[2] + p[15];
    eye[0] = (x * w - p[8] * eye[2] - p[12]) / p[0];
    eye[1] = (y * w - p[9] * eye[2] - p[13]) / p[5];
    Matrix4d turn = identity_matrix;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) turn[c * 4 + r] = linear_[r][c];
    const auto back = affine_inverse(turn);
    if (!back) return camera_.origin;
    Vec3d away{};
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) away[r] += (*back)[c * 4 + r] * eye[c];
    return (away + eye_) + camera_.origin;
}

std::optional<std::pair<Vec3d, Vec3d>> ScreenMap::clipped(const Vec3d& a, const Vec3d& b, double margin) const
{
    if (!is_finite(a) || !is_finite(b)) return std::nullopt;
    const Vec4d from = clip_of(a), to = clip_of(b);
    const double wide = 1 + 2 * margin / camera_.width, high = 1 + 2 * margin / camera_.height;
    // What is positive inside: w + z, and the four sides.
    const auto values = [&](const Vec4d& c) {
        return std::array<double, 5>{c[3] + c[2], wide * c[3] - c[0], wide * c[3] + c[0], high * c[3] - c[1],
                                     high * c[3] + c[1]};
    };
    const auto first = values(from), last = values(to);
    double begin = 0, end = 1;
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (!(first[i] >= 0) && !(last[i] >= 0)) return std::nullopt;
        const double crossing = first[i] / (first[i] - last[i]);
        if (first[i] < 0) begin = std::max(begin, crossing);
        if (last[i] < 0) end = std::min(end, crossing);
    }
    if (!(begin <= end)) return std::nullopt;
    const auto at = [&](double t) { return t == 0 ? a : t == 1 ? b : a + t * (b - a); };
    const Vec3d p = at(begin), q = at(end);
    if (!(clip_of(p)[3] > 0) || !(clip_of(q)[3] > 0)) return std::nullopt;
    return std::pair{p, q};
}

double ScreenMap::pixel_at(const Vec3d& eye) const
{
    return std::fabs(clip_of(eye)[3]) / (std::fabs(camera_.projection[5]) * camera_.height / 2);
}

}  // namespace pcm
