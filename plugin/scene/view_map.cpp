#include "plugin/scene/view_map.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <cmath>

namespace pcm::host {

namespace {

Vec3d image_of(const Matrix4d& m, const Vec3d& p)
{
    Vec3d q;
    for (std::size_t r = 0; r < 3; ++r) q[r] = m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
    return q;
}

}  // namespace

ViewMap::ViewMap(const Camera& camera, double ratio) : camera_(camera), ratio_(ratio)
{
    const auto inverse = affine_inverse(camera.modelview);
    if (!inverse || !is_finite(camera.projection) || camera.width <= 0 || camera.height <= 0 || !(ratio > 0) ||
        camera.projection[0] == 0 || camera.projection[5] == 0)
        throw Error(ErrorCode::invalid_argument, {}, "the view's camera cannot be inverted");
    inverse_ = *inverse;
    back_ = normalised(Vec3d{inverse_[8], inverse_[9], inverse_[10]});
}

Vec3d ViewMap::eye_space(const Vec3d& place) const { return image_of(camera_.modelview, place - camera_.origin); }

std::optional<QPointF> ViewMap::pixel_of(const Vec3d& place) const
{
    const Vec3d e = eye_space(place);
    const Matrix4d& p = camera_.projection;
    const double w = p[3] * e[0] + p[7] * e[1] + p[11] * e[2] + p[15];
    if (!(w > 0)) return std::nullopt;
    const double x = (p[0] * e[0] + p[4] * e[1] + p[8] * e[2] + p[12]) / w;
    const double y = (p[1] * e[0] + p[5] * e[1] + p[9] * e[2] + p[13]) / w;
    const QPointF pixel((x + 1) / 2 * camera_.width / ratio_, (1 - y) / 2 * camera_.height / ratio_);
    if (!std::isfinite(pixel.x()) || !std::isfinite(pixel.y())) return std::nullopt;
    return pixel;
}

std::array<double, 2> ViewMap::device(const QPointF& pixel) const
{
    return {2 * pixel.x() * ratio_ / camera_.width - 1, 1 - 2 * pixel.y() * ratio_ / camera_.height};
}

SceneRay ViewMap::ray(const QPointF& pixel) const
{
    const auto [x, y] = device(pixel);
    const Matrix4d& p = camera_.projection;
    const Vec3d from =
        is_parallel() ? Vec3d{(x * p[15] - p[12]) / p[0], (y * p[15] - p[13]) / p[5], 0} : Vec3d{0, 0, 0};
    const Vec3d ahead = is_parallel() ? Vec3d{0, 0, -1} : Vec3d{(x + p[8]) / p[0], (y + p[9]) / p[5], -1};
    Vec3d direction;
    for (std::size_t r = 0; r < 3; ++r)
        direction[r] = inverse_[r] * ahead[0] + inverse_[4 + r] * ahead[1] + inverse_[8 + r] * ahead[2];
    return {image_of(inverse_, from) + camera_.origin, normalised(direction)};
}

Vec3d ViewMap::place_at(const QPointF& pixel) const
{
    // The depth whose device coordinate is 0: p[10] z + p[14] = 0.
    const Matrix4d& p = camera_.projection;
    const double depth = p[14] / p[10];
    const auto [x, y] = device(pixel);
    const double w = is_parallel() ? p[15] : depth;
    const Vec3d eye{(x * w - p[12] + p[8] * depth) / p[0], (y * w - p[13] + p[9] * depth) / p[5], -depth};
    return image_of(inverse_, eye) + camera_.origin;
}

double ViewMap::pixel_size(const Vec3d& place) const
{
    const Matrix4d& p = camera_.projection;
    const Vec3d e = eye_space(place);
    const double w = std::fabs(p[3] * e[0] + p[7] * e[1] + p[11] * e[2] + p[15]);
    const double scale =
        length(Vec3d{inverse_[0], inverse_[1], inverse_[2]});  // units of the scene per unit of the eye's
    return 2 * w * ratio_ / (camera_.height * std::fabs(p[5])) * scale;
}

}  // namespace pcm::host
