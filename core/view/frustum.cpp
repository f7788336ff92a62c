#include "pcm/view/frustum.h"

#include "pcm/cloud/numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pcm {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// The three components of a projection's row; the fourth is m[12 + row].
Vec3d row_of(const Matrix4d& m, std::size_t row) { return {m[row], m[4 + row], m[8 + row]}; }

// Solves rows * x = b by Gaussian elimination with pivoting; absent when the matrix is singular. Scaled first, so that
// matrices in units of 1e-100 are not taken for singular.
std::optional<Vec3d> solve(std::array<Vec3d, 3> rows, Vec3d b)
{
    double largest = 0;
    for (const Vec3d& row : rows)
        for (const double v : row) largest = std::max(largest, std::abs(v));
    if (!(largest > 0)) return std::nullopt;
    for (std::size_t r = 0; r < 3; ++r) {
        for (double& v : rows[r]) v /= largest;
        b[r] /= largest;
    }
    for (std::size_t column = 0; column < 3; ++column) {
        std::size_t pivot = column;
        for (std::size_t r = column + 1; r < 3; ++r)
            if (std::abs(rows[r][column]) > std::abs(rows[pivot][column])) pivot = r;
        if (!(std::abs(rows[pivot][column]) > 4 * epsilon)) return std::nullopt;
        std::swap(rows[pivot], rows[column]);
        std::swap(b[pivot], b[column]);
        for (std::size_t r = column + 1; r < 3; ++r) {
            const double factor = rows[r][column] / rows[column][column];
            for (std::size_t c = column; c < 3; ++c) rows[r][c] -= factor * rows[column][c];
            b[r] -= factor * b[column];
        }
    }
    Vec3d x{};
    for (std::size_t r = 3; r-- > 0;) {
        double sum = b[r];
        for (std::size_t c = r + 1; c < 3; ++c) sum -= rows[r][c] * x[c];
        x[r] = sum / rows[r][r];
    }
    return x;
}

// The length of the part of `g` that is perpendicular to `axis`.
double perpendicular(const Vec3d& g, const Vec3d& axis)
{
    const double along = dot(g, axis) / dot(axis, axis);
    return length(g - along * axis);
}

}  // namespace

std::optional<Frustum> Frustum::of(const Camera& view)
{
    if (view.width <= 0 || view.height <= 0 || !is_affine(view.modelview) || !is_finite(view.projection) ||
        !is_finite(view.origin))
        return std::nullopt;
    Matrix4d modelview = view.modelview;
    for (double& v : modelview) v /= view.modelview[15];

    const Matrix3d linear{row_of(modelview, 0), row_of(modelview, 1), row_of(modelview, 2)};
    const auto eye = solve(linear, {-modelview[12], -modelview[13], -modelview[14]});
    if (!eye) return std::nullopt;

    Frustum frustum;
    frustum.origin_ = view.origin;
    frustum.eye_ = *eye;
    if (!is_finite(frustum.eye_)) return std::nullopt;

    frustum.set_planes(linear, view.projection);
    if (!frustum.set_scale(linear, view)) return std::nullopt;
    return frustum;
}

// Eye space is linear * (p - eye), so a plane of the projection keeps its offset, and its normal is multiplied by the
// transposed linear part. The translation of the modelview, which is large at map coordinates, is not used.
void Frustum::set_planes(const Matrix3d& linear, const Matrix4d& projection)
{
    const auto to_source = [&](const Vec3d& n) {
        Vec3d turned{};
        for (std::size_t a = 0; a < 3; ++a) turned[a] = n[0] * linear[0][a] + n[1] * linear[1][a] + n[2] * linear[2][a];
        return turned;
    };
    const auto to_source_bound = [&](const Vec3d& n) {
        Vec3d bound{};
        for (std::size_t a = 0; a < 3; ++a)
            bound[a] = n[0] * std::abs(linear[0][a]) + n[1] * std::abs(linear[1][a]) + n[2] * std::abs(linear[2][a]);
        return bound;
    };
    const Vec3d w = row_of(projection, 3);
    const double w_offset = projection[15];
    for (std::size_t i = 0; i < 6; ++i) {
        const std::size_t row = i / 2;
        const double sign = i % 2 == 0 ? 1 : -1;
        const Vec3d r = row_of(projection, row);
        Vec3d bound{};
        for (std::size_t a = 0; a < 3; ++a) bound[a] = std::abs(w[a]) + std::abs(r[a]);
        planes_[i] = {to_source(w + sign * r), w_offset + sign * projection[12 + row], to_source_bound(bound),
                      std::abs(w_offset) + std::abs(projection[12 + row])};
    }
}

bool Frustum::set_scale(const Matrix3d& linear, const Camera& view)
{
    double largest_scale = 0;
    double smallest_scale = infinity;
    for (std::size_t a = 0; a < 3; ++a) {
        const double scale = length({linear[0][a], linear[1][a], linear[2][a]});
        largest_scale = std::max(largest_scale, scale);
        smallest_scale = std::min(smallest_scale, scale);
    }
    const Vec3d x = row_of(view.projection, 0), y = row_of(view.projection, 1), w = row_of(view.projection, 3);
    const double w_offset = view.projection[15];
    orthographic_ = w[0] == 0 && w[1] == 0 && w[2] == 0;
    if (orthographic_) {
        if (w_offset == 0) return false;
        pixels_per_unit_ =
            largest_scale / std::abs(w_offset) * std::max(view.width * 0.5 * length(x), view.height * 0.5 * length(y));
    } else {
        // Along a plane of constant w, x_ndc changes by the part of x's gradient that is perpendicular to w's, over w;
        // and w is |w's gradient| times the distance on the axis.
        pixels_per_unit_ = largest_scale / smallest_scale / length(w) *
                           std::max(view.width * 0.5 * perpendicular(x, w), view.height * 0.5 * perpendicular(y, w));
        const Plane& near_plane = planes_[4];
        const double steepness = length(near_plane.normal);
        near_ = steepness > 0 ? std::max(0.0, -near_plane.offset / steepness) : 0.0;
    }
    return std::isfinite(pixels_per_unit_);
}

bool Frustum::intersects(const Box3d& box) const
{
    if (box.empty()) return false;
    for (const Plane& plane : planes_) {
        const Side side = side_of(plane, box, 1);
        if (side.value < -side.rounding) return false;
    }
    return true;
}

bool Frustum::contains(const Box3d& box) const
{
    if (box.empty()) return false;
    for (const Plane& plane : planes_) {
        const Side side = side_of(plane, box, -1);
        if (side.value < side.rounding) return false;
    }
    return true;
}

Frustum::Side Frustum::side_of(const Plane& plane, const Box3d& box, double sign) const
{
    double value = plane.offset;
    double bound = plane.offset_bound;
    for (std::size_t a = 0; a < 3; ++a) {
        const double corner = sign * plane.normal[a] >= 0 ? box.max[a] : box.min[a];
        value += plane.normal[a] * ((corner - origin_[a]) - eye_[a]);
        bound += plane.normal_bound[a] * (std::abs(corner) + std::abs(origin_[a]) + std::abs(eye_[a]));
    }
    // 16: a generous count of the operations from a coordinate to its clip coordinate, each off by half an epsilon.
    return {value, 16 * epsilon * bound};
}

double Frustum::pixels(double size, const Box3d& box) const
{
    if (!(size > 0)) return 0;
    if (orthographic_) return size * pixels_per_unit_;
    Vec3d away{};
    for (std::size_t a = 0; a < 3; ++a)
        away[a] = std::max({0.0, (box.min[a] - origin_[a]) - eye_[a], eye_[a] - (box.max[a] - origin_[a])});
    const double distance = std::max(length(away), near_);
    return distance > 0 ? size * pixels_per_unit_ / distance : infinity;
}

Vec3d Frustum::eye() const { return origin_ + eye_; }

}  // namespace pcm
