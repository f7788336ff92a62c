// A sphere: four points; moved along the normal of its patch, turned about two directions, curved.
#include "pcm/fit/models/shape_models.h"

#include <Eigen/LU>

namespace pcm {
namespace {

std::size_t solve(const SampledPoint* sample, Shape* solutions)
{
    Eigen::Matrix3d rows;
    Eigen::Vector3d squares;
    for (int k = 0; k < 3; ++k) {
        const Vec3d d = sample[k + 1].place - sample[0].place;
        for (int axis = 0; axis < 3; ++axis) rows(k, axis) = 2 * d[axis];
        squares[k] = dot(d, d);
    }
    const Eigen::Vector3d centre = rows.partialPivLu().solve(squares);
    if (!centre.allFinite()) return 0;
    const Vec3d c{centre[0], centre[1], centre[2]};
    solutions[0] = {ShapeKind::sphere, sample[0].place + c, {0, 0, 1}, length(c), 0};
    return solutions[0].radius > 0 ? 1 : 0;
}

void distances(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count, double* out)
{
    const Vec3d c = shape.point;
    const double r = shape.radius;
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = x[i] - c[0], dy = y[i] - c[1], dz = z[i] - c[2];
        out[i] = std::sqrt(dx * dx + dy * dy + dz * dz) - r;
    }
}

SurfacePatch patch_at(const Shape& shape, const Vec3d& middle)
{
    const Vec3d d = middle - shape.point;
    const double away = length(d);
    const Vec3d n = away > 0 ? d / away : Vec3d{0, 0, 1};
    SurfacePatch patch = models::patch_with_normal(shape.point + shape.radius * n, n);
    patch.curvature = 1 / shape.radius;
    return patch;
}

// The side of the curvature does not matter to what is on the surface.
Shape shape_of(const SurfacePatch& patch)
{
    return {
        ShapeKind::sphere, patch.place - (1 / patch.curvature) * patch.n, {0, 0, 1}, 1 / std::fabs(patch.curvature), 0};
}

void differentiate(const SurfacePatch& patch, const double* x, const double* y, const double* z, std::size_t count,
                   PatchBlock& out)
{
    const Vec3d o = patch.place, n = patch.n, a = patch.a, b = patch.b;
    const double k = patch.curvature;
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = x[i] - o[0], dy = y[i] - o[1], dz = z[i] - o[2];
        const double along = n[0] * dx + n[1] * dy + n[2] * dz, square = dx * dx + dy * dy + dz * dz;
        const double q = 2 * along + k * square, inside = 1 + k * q, w = std::sqrt(inside > 1e-24 ? inside : 1e-24);
        const double one = 1 / (1 + w), inverse = 1 / w;
        out.distance[i] = q * one;
        out.by[0][i] = -(1 + k * along) * inverse;
        out.by[1][i] = (b[0] * dx + b[1] * dy + b[2] * dz) * inverse;
        out.by[2][i] = -(a[0] * dx + a[1] * dy + a[2] * dz) * inverse;
        out.by[3][i] = (square * (1 + w) - q * (along + k * square) * inverse) * one * one;
    }
}

SurfacePatch moved(const SurfacePatch& patch, const double* step)
{
    SurfacePatch result = patch;
    result.place = patch.place + step[0] * patch.n;
    models::turn(result, step[1] * patch.a + step[2] * patch.b);
    result.curvature += step[3];
    return result;
}

}  // namespace

const ShapeModel& sphere_model()
{
    static const ShapeModel model{ShapeKind::sphere, 4,        4,        false,         {1, 0, 0, -1}, solve,
                                  distances,         patch_at, shape_of, differentiate, moved};
    return model;
}

}  // namespace pcm
