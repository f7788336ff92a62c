// A cylinder: two points with normals; moved along the normal of its patch, turned about three directions, curved.
#include "pcm/fit/models/shape_models.h"
#include "pcm/fit/pcl/pcl_module.h"

namespace pcm {
namespace {

std::size_t solve(const SampledPoint* sample, Shape* solutions)
{
    const Vec3d axis = cross(sample[0].normal, sample[1].normal);
    const double sine = length(axis);
    if (!(sine > 1e-6)) return 0;
    const Vec3d unit = axis / sine;
    const Vec3d between = sample[1].place - sample[0].place;
    const Vec3d q = sample[1].place - dot(between, unit) * unit;  // in the plane of the first point
    Vec3d on_first;
    if (!models::lines_meet(sample[0].place, sample[0].normal, q, sample[1].normal, on_first)) return 0;
    const double radius = (length(on_first - sample[0].place) + length(on_first - q)) / 2;
    solutions[0] = {ShapeKind::cylinder, on_first, unit, radius, 0};
    return radius > 0 ? 1 : 0;
}

void distances(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count, double* out)
{
    block_loops().cylinder.distances(models::numbers_of(shape), x, y, z, count, out);
}

SurfacePatch patch_at(const Shape& shape, const Vec3d& middle)
{
    const Vec3d d = middle - shape.point;
    const Vec3d foot = shape.point + dot(d, shape.axis) * shape.axis, across = cross(shape.axis, cross(d, shape.axis));
    const Vec3d n = length(across) > 0 ? normalised(across) : models::unit_across(shape.axis);
    SurfacePatch patch = models::patch_with_axis(foot + shape.radius * n, shape.axis, n);
    patch.curvature = 1 / shape.radius;
    return patch;
}

Shape shape_of(const SurfacePatch& patch)
{
    return {ShapeKind::cylinder, patch.place - (1 / patch.curvature) * patch.n, patch.a, 1 / std::fabs(patch.curvature),
            0};
}

void differentiate(const SurfacePatch& patch, const double* x, const double* y, const double* z, std::size_t count,
                   PatchBlock& out)
{
    block_loops().cylinder.differentiate(models::numbers_of(patch), x, y, z, count, out);
}

SurfacePatch moved(const SurfacePatch& patch, const double* step)
{
    SurfacePatch result = patch;
    result.place = patch.place + step[0] * patch.n;
    models::turn(result, step[1] * patch.a + step[2] * patch.n + step[3] * patch.b);
    result.curvature += step[4];
    return result;
}

bool like(const SurfaceBend& bend, Shape& shape)
{
    if (!bend.is_curved() || !(std::fabs(bend.k2) <= bend.doubt + 0.4 * std::fabs(bend.k1))) return false;
    const double radius = bend.radius(bend.k1);
    shape = {ShapeKind::cylinder, bend.place + std::copysign(radius, bend.k1) * bend.up, bend.straight, radius, 0};
    return true;
}

Shape shape_of_pcl(const double* c, const Vec3d& middle)
{
    return {ShapeKind::cylinder, middle + Vec3d{c[0], c[1], c[2]}, normalised({c[3], c[4], c[5]}), std::fabs(c[6]), 0};
}

constexpr PclForm pcl{PclModel::cylinder, shape_of_pcl};

}  // namespace

const ShapeModel& cylinder_model()
{
    static const ShapeModel model{cylinder_shape,
                                  2,
                                  true,
                                  1,
                                  4,
                                  {1, 0, 0, 0, -1},
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
