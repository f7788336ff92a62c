// A plane: three points; moved along its normal and turned about two directions.
#include "pcm/fit/models/shape_models.h"

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
    const Vec3d p = shape.point, n = shape.axis;
    for (std::size_t i = 0; i < count; ++i) out[i] = n[0] * (x[i] - p[0]) + n[1] * (y[i] - p[1]) + n[2] * (z[i] - p[2]);
}

SurfacePatch patch_at(const Shape& shape, const Vec3d& middle)
{
    return models::patch_with_normal(middle - dot(middle - shape.point, shape.axis) * shape.axis, shape.axis);
}

Shape shape_of(const SurfacePatch& patch) { return {ShapeKind::plane, patch.place, patch.n, 0, 0}; }

void differentiate(const SurfacePatch& patch, const double* x, const double* y, const double* z, std::size_t count,
                   PatchBlock& out)
{
    const Vec3d o = patch.place, n = patch.n, a = patch.a, b = patch.b;
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = x[i] - o[0], dy = y[i] - o[1], dz = z[i] - o[2];
        out.distance[i] = n[0] * dx + n[1] * dy + n[2] * dz;
        out.by[0][i] = -1;
        out.by[1][i] = b[0] * dx + b[1] * dy + b[2] * dz;     // turned about a
        out.by[2][i] = -(a[0] * dx + a[1] * dy + a[2] * dz);  // turned about b
    }
}

SurfacePatch moved(const SurfacePatch& patch, const double* step)
{
    SurfacePatch result = patch;
    result.place = patch.place + step[0] * patch.n;
    models::turn(result, step[1] * patch.a + step[2] * patch.b);
    return result;
}

}  // namespace

const ShapeModel& plane_model()
{
    static const ShapeModel model{ShapeKind::plane, 3,        3,        false,         {1, 0, 0}, solve,
                                  distances,        patch_at, shape_of, differentiate, moved};
    return model;
}

}  // namespace pcm
