// A sphere: four points; moved along the normal of its patch, turned about two directions, curved.
#include "pcm/fit/models/shape_models.h"
#include "pcm/fit/pcl/pcl_module.h"

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
    block_loops().sphere.distances(models::numbers_of(shape), x, y, z, count, out);
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
    block_loops().sphere.differentiate(models::numbers_of(patch), x, y, z, count, out);
}

SurfacePatch moved(const SurfacePatch& patch, const double* step)
{
    SurfacePatch result = patch;
    result.place = patch.place + step[0] * patch.n;
    models::turn(result, step[1] * patch.a + step[2] * patch.b);
    result.curvature += step[3];
    return result;
}

bool like(const SurfaceBend& bend, Shape& shape)
{
    if (!bend.is_curved() || !(std::fabs(bend.k1 - bend.k2) <= bend.doubt + 0.5 * std::fabs(bend.k1))) return false;
    const double radius = bend.radius(0.5 * (bend.k1 + bend.k2));
    shape = {ShapeKind::sphere, bend.place + std::copysign(radius, bend.k1) * bend.up, bend.up, radius, 0};
    return std::isfinite(radius);
}

Shape shape_of_pcl(const double* c, const Vec3d& middle)
{
    return {ShapeKind::sphere, middle + Vec3d{c[0], c[1], c[2]}, {0, 0, 1}, c[3], 0};
}

constexpr PclForm pcl{PclModel::sphere, shape_of_pcl};

}  // namespace

const ShapeModel& sphere_model()
{
    static const ShapeModel model{sphere_shape,
                                  4,
                                  false,
                                  1,
                                  1,
                                  {1, 0, 0, -1},
                                  &pcl,
                                  like,
                                  models::radius_significance,
                                  solve,
                                  distances,
                                  patch_at,
                                  shape_of,
                                  differentiate,
                                  moved};
    return model;
}

}  // namespace pcm
