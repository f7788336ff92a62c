// A plane: three points; moved along its normal and turned about two directions.
#include "pcm/fit/models/shape_models.h"
#include "pcm/fit/pcl/pcl_module.h"

namespace pcm {
namespace {

std::size_t solve(const SampledPoint* sample, Shape* solutions)
{
    const Vec3d u = sample[1].place - sample[0].place, v = sample[2].place - sample[0].place, n = cross(u, v);
    const double square = dot(n, n);
    if (!(square > 1e-24 * dot(u, u) * dot(v, v))) return 0;
    solutions[0] = {ShapeKind::plane, sample[0].place, n / std::sqrt(square), 0, 0};
    return 1;
}

void distances(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count, double* out)
{
    block_loops().plane.distances(models::numbers_of(shape), x, y, z, count, out);
}

SurfacePatch patch_at(const Shape& shape, const Vec3d& middle)
{
    return models::patch_with_normal(middle - dot(middle - shape.point, shape.axis) * shape.axis, shape.axis);
}

Shape shape_of(const SurfacePatch& patch) { return {ShapeKind::plane, patch.place, patch.n, 0, 0}; }

void differentiate(const SurfacePatch& patch, const double* x, const double* y, const double* z, std::size_t count,
                   PatchBlock& out)
{
    block_loops().plane.differentiate(models::numbers_of(patch), x, y, z, count, out);
}

SurfacePatch moved(const SurfacePatch& patch, const double* step)
{
    SurfacePatch result = patch;
    result.place = patch.place + step[0] * patch.n;
    models::turn(result, step[1] * patch.a + step[2] * patch.b);
    return result;
}

Significance no_significance(const Shape&, const ShapeErrors&) { return {}; }

bool like(const SurfaceBend& bend, Shape& shape)
{
    shape = {ShapeKind::plane, bend.place, bend.up, 0, 0};
    return true;
}

Shape shape_of_pcl(const double* c, const Vec3d& middle)
{
    const Vec3d n{c[0], c[1], c[2]}, unit = normalised(n);
    return {ShapeKind::plane, middle + (-c[3] / length(n)) * unit, unit, 0, 0};
}

constexpr PclForm pcl{PclModel::plane, shape_of_pcl};

}  // namespace

const ShapeModel& plane_model()
{
    static const ShapeModel model{plane_shape,     3,     false,     0,        0,        {1, 0, 0},     &pcl, like,
                                  no_significance, solve, distances, patch_at, shape_of, differentiate, moved};
    return model;
}

}  // namespace pcm
