#include "pcm/gl/draw/splat_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {

namespace {

using Matrix3 = std::array<double, 9>;  // column-major

Vec3d product(const Matrix3& m, const Vec3d& v)
{
    return {m[0] * v[0] + m[3] * v[1] + m[6] * v[2], m[1] * v[0] + m[4] * v[1] + m[7] * v[2],
            m[2] * v[0] + m[5] * v[1] + m[8] * v[2]};
}

// Of an invertible matrix; scaled, so that the determinant does not underflow for small units.
Matrix3 inverse(Matrix3 m)
{
    double largest = 0;
    for (const double v : m) largest = std::max(largest, std::abs(v));
    for (double& v : m) v /= largest;
    Matrix3 cofactors{};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r) {
            const std::size_t c1 = (c + 1) % 3, c2 = (c + 2) % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3;
            cofactors[c * 3 + r] = m[c1 * 3 + r1] * m[c2 * 3 + r2] - m[c1 * 3 + r2] * m[c2 * 3 + r1];
        }
    const double determinant = m[0] * cofactors[0] + m[1] * cofactors[1] + m[2] * cofactors[2];
    Matrix3 result{};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r) result[c * 3 + r] = cofactors[r * 3 + c] / determinant / largest;
    return result;
}

// The square root of an upper bound of the eigenvalues of M'M; exact where M only rotates and scales.
double largest_stretch(const Matrix3& m)
{
    double most = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        double sum = 0;
        for (std::size_t b = 0; b < 3; ++b) {
            double dot = 0;
            for (std::size_t r = 0; r < 3; ++r) dot += m[a * 3 + r] * m[b * 3 + r];
            sum += std::abs(dot);
        }
        most = std::max(most, sum);
    }
    return std::sqrt(most);
}

}  // namespace

std::optional<SplatCamera> SplatCamera::of(const Camera& view, int x, int y, bool reversed)
{
    const auto frustum = Frustum::of(view);
    if (!frustum) return std::nullopt;
    SplatCamera camera;
    camera.view = view;
    camera.eye = frustum->local_eye();
    camera.orthographic = frustum->orthographic();
    Matrix4d& modelview = camera.view.modelview;
    Matrix4d& p = camera.view.projection;
    const double affine = modelview[15];
    for (double& v : modelview) v /= affine;
    const double of_w = camera.orthographic ? p[15] : -p[11];
    if (!(std::abs(of_w) > 0)) return std::nullopt;
    for (double& v : p) v /= of_w;

    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r) camera.to_eye[c * 3 + r] = modelview[c * 4 + r];
    const Matrix3 from_eye = inverse(camera.to_eye);
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r) camera.normal_to_eye[c * 3 + r] = from_eye[r * 3 + c];
    camera.scale = largest_stretch(camera.to_eye);
    camera.squeeze = camera.scale * largest_stretch(from_eye);

    const double width = view.width;
    const double height = view.height;
    camera.focal = {width / 2 * p[0], height / 2 * p[5]};
    if (camera.orthographic) {
        camera.principal = {x + (1 + p[12]) * width / 2, y + (1 + p[13]) * height / 2};
        const double sign = reversed ? -0.5 : 0.5;
        camera.depth_of = {0.5 + sign * p[14], -sign * p[10]};
    } else {
        camera.principal = {x + (1 - p[8]) * width / 2, y + (1 - p[9]) * height / 2};
        // z / w is -p[10] + p[14] / depth. In double, because with near / far of 1e-6 p[10] differs from 1 only in the
        // sixth decimal.
        camera.depth_of = reversed ? std::array<double, 2>{(1 + p[10]) / 2, -p[14] / 2}
                                   : std::array<double, 2>{(1 - p[10]) / 2, p[14] / 2};
        const double near = p[14] / (p[10] - 1);
        camera.near = near > 0 ? near : 0;
    }
    camera.centre_pixel = {std::floor(x + width / 2) + 0.5, std::floor(y + height / 2) + 0.5};
    camera.pixel_x = product(from_eye, {1 / camera.focal[0], 0, 0});
    camera.pixel_y = product(from_eye, {0, 1 / camera.focal[1], 0});
    const auto slope = [&](std::size_t a) {
        return camera.orthographic ? 0 : (camera.centre_pixel[a] - camera.principal[a]) / camera.focal[a];
    };
    camera.centre_ray = product(from_eye, {slope(0), slope(1), -1});

    Matrix4d clip = p;
    if (reversed)
        for (std::size_t c = 0; c < 4; ++c) clip[c * 4 + 2] = 0.5 * (p[c * 4 + 3] - p[c * 4 + 2]);
    for (std::size_t i = 0; i < 16; ++i) camera.projection[i] = static_cast<float>(clip[i]);
    return camera;
}

Vec3d SplatCamera::eye_of(const Vec3d& local) const
{
    const Vec3d turned = product(to_eye, local);
    return {turned[0] + view.modelview[12], turned[1] + view.modelview[13], turned[2] + view.modelview[14]};
}

bool SplatCamera::is_in_view(const Vec3d& local) const
{
    const Vec3d e = eye_of(local);
    const Matrix4d& p = view.projection;
    const double w = orthographic ? 1 : -e[2];
    return std::abs(p[0] * e[0] + p[8] * e[2] + p[12]) <= w && std::abs(p[5] * e[1] + p[9] * e[2] + p[13]) <= w;
}

double SplatCamera::least_depth(const Box3d& box) const
{
    double least = std::numeric_limits<double>::infinity();
    for (unsigned corner = 0; corner < 8; ++corner) {
        Vec3d place{};
        for (std::size_t a = 0; a < 3; ++a) place[a] = (corner >> a) & 1 ? box.max[a] : box.min[a];
        least = std::min(least, -eye_of(place)[2]);
    }
    return least;
}

double SplatCamera::largest_square(const Box3d& box, double radius) const
{
    const double side = radius * scale * std::abs(square_pixels());
    // Centres nearer than the near plane are not drawn.
    return std::max(orthographic ? side : side / std::max(least_depth(box), near), 1.0);
}

double SplatCamera::largest_box(const Box3d& box, double radius) const
{
    const double r = radius * scale;
    if (orthographic) return bound_of(r);
    const double depth = least_depth(box) - r;
    return bound_of(depth > 0 ? r / depth : std::numeric_limits<double>::infinity());
}

double SplatCamera::largest_box_of(double pixels) const
{
    const double k = 0.5 * pixels / std::abs(focal[1]);
    if (orthographic) return bound_of(k);
    return bound_of(k < 1 ? k / (1 - k) : std::numeric_limits<double>::infinity());
}

// For a disc of radius k (orthographic), or of k times the depth of its nearest point.
double SplatCamera::bound_of(double k) const
{
    constexpr double spare = 4;  // pixels: the margin of shaders/splat.vert, and rounding
    // No box is drawn beyond the viewport.
    const double viewport = std::max(view.width, view.height) + spare;
    const double pixels = std::max(std::abs(focal[0]), std::abs(focal[1]));
    if (orthographic) return std::min(viewport, 2.02 * k * pixels + spare);
    // For a point q of the sphere around c, with x the tangent of its angle to the axis: |x_q - x_c| <= r (1 + |x_c|) /
    // depth_q. A visible box is at most its half size e away from the view, where |x| <= v, so e <= k (1 + v + e).
    if (!(k < 0.5)) return viewport;
    double v = 0;
    for (std::size_t a = 0; a < 2; ++a)
        v = std::max(v, (1 + std::abs(view.projection[8 + a])) / std::abs(view.projection[a * 5]));
    return std::min(viewport, 2.02 * k * (1 + v) / (1 - k) * pixels + spare);
}

}  // namespace pcm
