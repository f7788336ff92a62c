// A torus: four points with normals, whose lines all meet the axis (two lines do). In its patch `curvature` is that of
// the circle that the tube follows, through the place on it nearest to the patch, and `second` that of the tube.
#include "pcm/fit/models/shape_models.h"

#include <Eigen/LU>

namespace pcm {
namespace {

// The circle through points (q, h): least squares of q^2 + h^2 - 2 q0 q - 2 h0 h = c.
bool tube_of(const Vec3d& on_axis, const Vec3d& axis, const SampledPoint* sample, Shape& shape)
{
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3d d = sample[k].place - on_axis;
        const double h = dot(d, axis), q = length(d - h * axis);
        const Eigen::Vector3d row(2 * q, 2 * h, 1);
        a += row * row.transpose();
        b += (q * q + h * h) * row;
    }
    const Eigen::Vector3d x = a.fullPivLu().solve(b);
    const double square = x[2] + x[0] * x[0] + x[1] * x[1];
    if (!x.allFinite() || !(square > 0)) return false;
    shape = {ShapeKind::torus, on_axis + x[1] * axis, axis, x[0], std::sqrt(square)};
    return shape.second < shape.radius;
}

// A line in Pluecker coordinates, direction d and moment m, meets the normals' lines where d.m_i + m.n_i = 0.
std::size_t solve(const SampledPoint* sample, Shape* solutions)
{
    const Vec3d origin = sample[0].place;
    Eigen::Matrix<double, 4, 6> rows;
    for (int k = 0; k < 4; ++k) {
        const Vec3d n = sample[k].normal, m = cross(sample[k].place - origin, n);
        rows.row(k) << m[0], m[1], m[2], n[0], n[1], n[2];
    }
    Eigen::FullPivLU<Eigen::Matrix<double, 4, 6>> system(rows);
    if (system.rank() < 4) return 0;
    const Eigen::Matrix<double, 6, 2> lines = system.kernel();
    const auto u = lines.col(0), v = lines.col(1);
    // d.m = 0 of u + t v
    const double c = u.head<3>().dot(u.tail<3>()), a = v.head<3>().dot(v.tail<3>());
    const double half = (u.head<3>().dot(v.tail<3>()) + v.head<3>().dot(u.tail<3>())) / 2, root = half * half - a * c;
    if (!(root >= 0)) return 0;
    std::size_t found = 0;
    const double both = -half - std::copysign(std::sqrt(root), half);  // roots both / a and c / both
    for (const auto& [top, bottom] : {std::pair<double, double>{both, a}, {c, both}}) {
        const Eigen::Matrix<double, 6, 1> line = bottom * u + top * v;
        const Vec3d d{line[0], line[1], line[2]}, m{line[3], line[4], line[5]};
        const double square = dot(d, d);
        if (!(square > 1e-16 * line.squaredNorm())) continue;
        const Vec3d foot = origin + cross(d, m) / square;
        if (is_finite(foot) && tube_of(foot, normalised(d), sample, solutions[found])) ++found;
    }
    return found;
}

void distances(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count, double* out)
{
    const Vec3d o = shape.point, a = shape.axis;
    const double large = shape.radius, tube = shape.second;
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = x[i] - o[0], dy = y[i] - o[1], dz = z[i] - o[2];
        const double cx = a[1] * dz - a[2] * dy, cy = a[2] * dx - a[0] * dz, cz = a[0] * dy - a[1] * dx;
        const double h = a[0] * dx + a[1] * dy + a[2] * dz, u = std::sqrt(cx * cx + cy * cy + cz * cz) - large;
        out[i] = std::sqrt(u * u + h * h) - tube;
    }
}

SurfacePatch patch_at(const Shape& shape, const Vec3d& middle)
{
    const Vec3d d = middle - shape.point;
    const double h = dot(d, shape.axis);
    const Vec3d across = cross(shape.axis, cross(d, shape.axis));
    const double q = length(across), u = q - shape.radius, away = std::hypot(u, h);
    const Vec3d n = q > 0 ? across / q : models::unit_across(shape.axis);
    const double out = away > 0 ? u / away : 1, along = away > 0 ? h / away : 0;
    const Vec3d place = shape.point + shape.radius * n + shape.second * (out * n + along * shape.axis);
    SurfacePatch patch = models::patch_with_axis(place, shape.axis, n);
    patch.out = out;
    patch.along = along;
    patch.curvature = 1 / shape.radius;
    patch.second = 1 / shape.second;
    return patch;
}

Shape shape_of(const SurfacePatch& patch)
{
    const double tube = 1 / patch.second, radius = 1 / patch.curvature;
    return {ShapeKind::torus, patch.place - tube * patch.normal() - radius * patch.n, patch.a, std::fabs(radius), tube};
}

void differentiate(const SurfacePatch& patch, const double* x, const double* y, const double* z, std::size_t count,
                   PatchBlock& out)
{
    const double tube = 1 / patch.second, k = patch.curvature, wn = patch.out, wa = patch.along;
    const Vec3d o = patch.place, n = patch.n, a = patch.a, b = patch.b;
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = x[i] - o[0], dy = y[i] - o[1], dz = z[i] - o[2];
        const double en = n[0] * dx + n[1] * dy + n[2] * dz, eb = b[0] * dx + b[1] * dy + b[2] * dz,
                     ea = a[0] * dx + a[1] * dy + a[2] * dz;
        const double cn = en + tube * wn, h = ea + tube * wa;  // relative to the circle's nearest place
        const double square = cn * cn + eb * eb;
        const double q = 2 * cn + k * square, inside = 1 + k * q, w = std::sqrt(inside > 1e-24 ? inside : 1e-24);
        const double one = 1 / (1 + w), inverse = 1 / w, u = q * one;
        const double away = std::sqrt(u * u + h * h), each = 1 / (away > 1e-300 ? away : 1e-300);
        const double ga = h * each, gu = u * each, gn = gu * (1 + k * cn) * inverse, gb = gu * k * eb * inverse;
        out.distance[i] = away - tube;
        out.by[0][i] = -(gn * wn + ga * wa);
        out.by[1][i] = gn * wa - ga * wn;  // along the tube's circle
        out.by[2][i] = eb * gn - en * gb;  // turned about a
        out.by[3][i] = ea * gb - eb * ga;  // about n
        out.by[4][i] = en * ga - ea * gn;  // about b
        out.by[5][i] = gu * (square * (1 + w) - q * (cn + k * square) * inverse) * one * one;
        out.by[6][i] = tube * tube * (1 - gn * wn - ga * wa);
    }
}

SurfacePatch moved(const SurfacePatch& patch, const double* step)
{
    SurfacePatch result = patch;
    result.place = patch.place + step[0] * patch.normal() + step[1] * (patch.out * patch.a - patch.along * patch.n);
    models::turn(result, step[2] * patch.a + step[3] * patch.n + step[4] * patch.b);
    result.curvature += step[5];
    result.second += step[6];
    return result;
}

Significance significance(const Shape& shape, const ShapeErrors& errors)
{
    return {shape.second / errors.second, shape.radius / errors.radius};
}

}  // namespace

const ShapeModel& torus_model()
{
    static const ShapeModel model{
        torus_shape,  4,     true,      2,        0,        {1, 1, 0, 0, 0, -1, -1}, nullptr, nullptr,
        significance, solve, distances, patch_at, shape_of, differentiate,           moved};
    return model;
}

}  // namespace pcm
