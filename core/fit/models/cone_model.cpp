// A cone: three points with normals, whose tangent planes meet in the apex. Its patch is a cylinder's with a slope:
// `second` is the angle by which it widens along `a`, and of f, the distance from the cylinder, and h along `a`, the
// distance is f cos - h sin. So a cone that is almost a cylinder is well scaled.
#include "pcm/fit/models/shape_models.h"
#include "pcm/fit/pcl/pcl_module.h"

#include <Eigen/LU>

namespace pcm {
namespace {

std::size_t solve(const SampledPoint* sample, Shape* solutions)
{
    Eigen::Matrix3d normals;
    Eigen::Vector3d heights;
    for (int k = 0; k < 3; ++k) {
        const SampledPoint& point = sample[k];
        normals.row(k) << point.normal[0], point.normal[1], point.normal[2];
        heights[k] = dot(point.normal, point.place - sample[0].place);
    }
    if (!(std::fabs(normals.determinant()) > 1e-9)) return 0;
    const Eigen::Vector3d meet = normals.partialPivLu().solve(heights);
    const Vec3d apex = sample[0].place + Vec3d{meet[0], meet[1], meet[2]};
    Vec3d to[3];
    for (std::size_t k = 0; k < 3; ++k) {
        to[k] = sample[k].place - apex;
        const double away = length(to[k]);
        if (!(away > 0) || !std::isfinite(away)) return 0;
        to[k] = to[k] / away;
    }
    const Vec3d across = cross(to[1] - to[0], to[2] - to[0]);
    if (!(length(across) > 1e-12)) return 0;
    const Vec3d axis = dot(across, to[0]) < 0 ? -1.0 * normalised(across) : normalised(across);
    // All three are at the same angle; 0 < cosine.
    const double angle = std::acos(std::min(1.0, dot(axis, to[0])));
    solutions[0] = {ShapeKind::cone, apex, axis, 0, angle};
    return angle > 1e-4 && angle < pi / 2 - 1e-4 ? 1 : 0;
}

void distances(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count, double* out)
{
    const Vec3d o = shape.point, a = shape.axis;
    const double c = std::cos(shape.second), s = std::sin(shape.second);
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = x[i] - o[0], dy = y[i] - o[1], dz = z[i] - o[2];
        const double cx = a[1] * dz - a[2] * dy, cy = a[2] * dx - a[0] * dz, cz = a[0] * dy - a[1] * dx;
        const double h = a[0] * dx + a[1] * dy + a[2] * dz, across = cx * cx + cy * cy + cz * cz;
        const double q = std::sqrt(across), away = std::sqrt(across + h * h);
        out[i] = h * c + q * s < 0 ? away : q * c - h * s;
    }
}

SurfacePatch patch_at(const Shape& shape, const Vec3d& middle)
{
    const Vec3d d = middle - shape.point;
    const double h = dot(d, shape.axis), c = std::cos(shape.second), s = std::sin(shape.second);
    const Vec3d across = cross(shape.axis, cross(d, shape.axis));
    const double q = length(across), away = length(d);
    const Vec3d n = q > 0 ? across / q : models::unit_across(shape.axis);
    const double nearest = h * c + q * s, least = away > 0 ? 0.1 * away : 1;
    const double along = nearest > least ? nearest : least;  // from the apex, not at it
    SurfacePatch patch =
        models::patch_with_axis(shape.point + (along * c) * shape.axis + (along * s) * n, shape.axis, n);
    patch.curvature = 1 / (along * s);
    patch.second = shape.second;
    patch.out = c;
    patch.along = -s;
    return patch;
}

Shape shape_of(const SurfacePatch& patch)
{
    const double radius = 1 / patch.curvature, slope = std::tan(patch.second);
    const Vec3d apex = patch.place - radius * patch.n - (radius / slope) * patch.a;
    return {ShapeKind::cone, apex, (slope * radius < 0 ? -1.0 : 1.0) * patch.a, 0, std::fabs(patch.second)};
}

void differentiate(const SurfacePatch& patch, const double* x, const double* y, const double* z, std::size_t count,
                   PatchBlock& out)
{
    const Vec3d o = patch.place, n = patch.n, a = patch.a, b = patch.b;
    const double k = patch.curvature, c = std::cos(patch.second), s = std::sin(patch.second);
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = x[i] - o[0], dy = y[i] - o[1], dz = z[i] - o[2];
        const double en = n[0] * dx + n[1] * dy + n[2] * dz, eb = b[0] * dx + b[1] * dy + b[2] * dz,
                     ea = a[0] * dx + a[1] * dy + a[2] * dz;
        const double square = en * en + eb * eb;
        const double q = 2 * en + k * square, inside = 1 + k * q, w = std::sqrt(inside > 1e-24 ? inside : 1e-24);
        const double one = 1 / (1 + w), inverse = 1 / w, f = q * one;
        const double ga = -s, gn = c * (1 + k * en) * inverse, gb = c * k * eb * inverse;  // the gradient
        out.distance[i] = f * c - ea * s;
        out.by[0][i] = -(gn * c - ga * s);
        out.by[1][i] = eb * gn - en * gb;  // turned about a
        out.by[2][i] = ea * gb - eb * ga;  // about n
        out.by[3][i] = en * ga - ea * gn;  // about b
        out.by[4][i] = c * (square * (1 + w) - q * (en + k * square) * inverse) * one * one;
        out.by[5][i] = -f * s - ea * c;
    }
}

SurfacePatch moved(const SurfacePatch& patch, const double* step)
{
    SurfacePatch result = patch;
    result.place = patch.place + step[0] * patch.normal();
    models::turn(result, step[1] * patch.a + step[2] * patch.n + step[3] * patch.b);
    result.curvature += step[4];
    result.second += step[5];
    result.out = std::cos(result.second);
    result.along = -std::sin(result.second);
    return result;
}

Significance significance(const Shape& shape, const ShapeErrors& errors)
{
    return {(pi / 2 - shape.second) / errors.second, shape.second / errors.second};
}

// Between the axis and a line from the apex along the surface; PCL's distances have no other sign of the axis win.
Shape shape_of_pcl(const double* c, const Vec3d& middle)
{
    return {ShapeKind::cone, middle + Vec3d{c[0], c[1], c[2]}, normalised({c[3], c[4], c[5]}), 0, c[6]};
}

constexpr PclForm pcl{PclModel::cone, shape_of_pcl};

}  // namespace

const ShapeModel& cone_model()
{
    static const ShapeModel model{
        cone_shape,   3,     true,      2,        0,        {1, 0, 0, 0, -1, 0}, &pcl, nullptr,
        significance, solve, distances, patch_at, shape_of, differentiate,       moved};
    return model;
}

}  // namespace pcm
