#include "pcm/pick/pick_ray.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcm {
namespace {

using Rows = std::array<Vec3d, 3>;

Vec3d row_of(const Matrix4d& m, std::size_t row) { return {m[row], m[4 + row], m[8 + row]}; }

// Solves rows * x = b by Cramer's rule, of rows scaled to length 1. Absent when they are dependent.
std::optional<Vec3d> solve(Rows rows, Vec3d b)
{
    for (std::size_t r = 0; r < 3; ++r) {
        const double size = length(rows[r]);
        if (!(size > 0) || !std::isfinite(size)) return std::nullopt;
        rows[r] = rows[r] / size;
        b[r] /= size;
    }
    const Vec3d yz = cross(rows[1], rows[2]), zx = cross(rows[2], rows[0]), xy = cross(rows[0], rows[1]);
    const double determinant = dot(rows[0], yz);
    if (!(std::fabs(determinant) > 1e-12)) return std::nullopt;
    const Vec3d x = (1 / determinant) * (b[0] * yz + b[1] * zx + b[2] * xy);
    return is_finite(x) ? std::optional<Vec3d>(x) : std::nullopt;
}

// A ray in eye space: q + t * direction.
struct EyeRay {
    Vec3d from{}, direction{};
    double pixel = 0, pixel_growth = 0;
    double begin = 0, end = std::numeric_limits<double>::infinity();
};

// The points of eye space that a projection maps to (u, v): where the planes row0 - u row3 and row1 - v row3 meet.
std::optional<EyeRay> eye_ray(const Matrix4d& p, double u, double v, int height)
{
    const Vec3d depth = row_of(p, 2), w = row_of(p, 3);
    const bool parallel = w == Vec3d{0, 0, 0};
    const Vec3d a = row_of(p, 0) - u * w, b = row_of(p, 1) - v * w;
    const double a_offset = p[12] - u * p[15], b_offset = p[13] - v * p[15];
    EyeRay ray;
    ray.direction = normalised(cross(a, b));
    if (!is_finite(ray.direction)) return std::nullopt;
    const double sign = parallel ? dot(depth, ray.direction) * p[15] : dot(w, ray.direction);
    if (!(sign != 0)) return std::nullopt;
    if (sign < 0) ray.direction = -1.0 * ray.direction;
    // In perspective from the eye, where w is 0; else from the near plane, where z is -w.
    const auto from = parallel ? solve({a, b, depth}, {-a_offset, -b_offset, -(p[14] + p[15])})
                               : solve({a, b, w}, {-a_offset, -b_offset, -p[15]});
    if (!from) return std::nullopt;
    ray.from = *from;
    const double of_w = 2 / (height * std::fabs(p[5]));
    ray.pixel = parallel ? of_w * std::fabs(p[15]) : 0;
    ray.pixel_growth = parallel ? 0 : of_w * dot(w, ray.direction);
    const Vec3d nearer = w + depth, farther = w - depth;
    const double near_slope = dot(nearer, ray.direction), far_slope = dot(farther, ray.direction);
    const double turn = parallel && p[15] < 0 ? -1 : 1;
    if (!parallel && near_slope > 0) ray.begin = std::max(0.0, -(dot(nearer, ray.from) + p[14] + p[15]) / near_slope);
    if (turn * far_slope < 0) {
        const double end = -(dot(farther, ray.from) + p[15] - p[14]) / far_slope;
        if (end > ray.begin) ray.end = end;
    }
    return ray;
}

}  // namespace

std::optional<PickRay> PickRay::through(const Camera& camera, double x, double y)
{
    if (camera.width <= 0 || camera.height <= 0 || !is_affine(camera.modelview) || !is_finite(camera.projection) ||
        !is_finite(camera.origin) || !std::isfinite(x) || !std::isfinite(y))
        return std::nullopt;
    Matrix4d m = camera.modelview;
    for (double& v : m) v /= camera.modelview[15];
    const Rows to_eye{row_of(m, 0), row_of(m, 1), row_of(m, 2)};
    const auto in_eye = eye_ray(camera.projection, 2 * x / camera.width - 1, 1 - 2 * y / camera.height, camera.height);
    if (!in_eye) return std::nullopt;
    const auto eye = solve(to_eye, {-m[12], -m[13], -m[14]}), from = solve(to_eye, in_eye->from),
               towards = solve(to_eye, in_eye->direction);
    if (!eye || !from || !towards) return std::nullopt;
    const double unit = length(*towards);
    PickRay ray;
    ray.centre = camera.origin;
    ray.start = *eye + *from;
    ray.direction = *towards / unit;
    ray.pixel = in_eye->pixel * unit;
    ray.pixel_growth = in_eye->pixel_growth;
    ray.begin = in_eye->begin * unit;
    ray.end = in_eye->end * unit;
    if (!is_finite(ray.direction) || !std::isfinite(ray.pixel) || !std::isfinite(ray.pixel_growth)) return std::nullopt;
    return ray;
}

PickRay PickRay::along(const Vec3d& from, const Vec3d& direction, double pixel, double pixel_growth)
{
    const auto refuse = [](const std::string& what, const char* hint) {
        throw Error(ErrorCode::invalid_argument, {}, what, hint);
    };
    require_place("the start of the ray,", from);
    if (!is_finite(direction) || !(length(direction) > 0))
        refuse("the ray has the direction " + exact(direction), "give three finite numbers that are not all 0");
    for (const double size : {pixel, pixel_growth})
        if (!(size >= 0) || !std::isfinite(size))
            refuse("the size of a pixel is " + exact(size), "give a finite number that is not negative");
    PickRay ray;
    ray.centre = from;
    ray.direction = normalised(direction);
    ray.pixel = pixel;
    ray.pixel_growth = pixel_growth;
    return ray;
}

// The placement maps p to L (p - pivot) + target, so centre + start comes from pivot + L^-1 ((centre - target) +
// start).
std::optional<PickRay> PickRay::before(const Affine& placement) const
{
    const auto from = solve(placement.linear, (centre - placement.target) + start);
    const auto towards = solve(placement.linear, direction);
    if (!from || !towards) return std::nullopt;
    const double unit = length(*towards);
    PickRay ray = *this;
    ray.centre = placement.pivot;
    ray.start = *from;
    ray.direction = *towards / unit;
    ray.pixel *= unit;
    ray.begin *= unit;
    ray.end *= unit;
    ray.scale *= unit;
    if (!is_finite(ray.direction) || !std::isfinite(ray.pixel)) return std::nullopt;
    return ray;
}

}  // namespace pcm
