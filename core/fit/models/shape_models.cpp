#include "pcm/fit/models/shape_models.h"

#include <cmath>

namespace pcm {

const ShapeModel& model_of(ShapeKind kind)
{
#define PCM_SHAPE_MODEL(name) &name##_model(),
    static const std::array rows{PCM_SHAPE_KINDS(PCM_SHAPE_MODEL)};
#undef PCM_SHAPE_MODEL
    return *rows[static_cast<std::size_t>(kind)];
}

namespace models {

Significance radius_significance(const Shape& shape, const ShapeErrors& errors)
{
    return {shape.radius / errors.radius, infinity};
}

ShapeNumbers numbers_of(const Shape& shape)
{
    const Vec3d &p = shape.point, &a = shape.axis;
    return {{p[0], p[1], p[2]}, {a[0], a[1], a[2]}, shape.radius, shape.second};
}

PatchNumbers numbers_of(const SurfacePatch& patch)
{
    const Vec3d &o = patch.place, &a = patch.a, &n = patch.n, &b = patch.b;
    return {{o[0], o[1], o[2]}, {a[0], a[1], a[2]}, {n[0], n[1], n[2]}, {b[0], b[1], b[2]}, patch.curvature};
}

Vec3d unit_across(const Vec3d& axis)
{
    std::size_t least = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (std::fabs(axis[k]) < std::fabs(axis[least])) least = k;
    Vec3d unit{};
    unit[least] = 1;
    return normalised(cross(axis, unit));
}

void turn(SurfacePatch& patch, const Vec3d& rotation)
{
    const double angle = length(rotation);
    if (!(angle > 0)) return;
    const Vec3d axis = rotation / angle;
    const double s = std::sin(angle), c = std::cos(angle);
    const auto turned = [&](const Vec3d& v) { return c * v + s * cross(axis, v) + ((1 - c) * dot(axis, v)) * axis; };
    patch.a = normalised(turned(patch.a));
    const Vec3d n = turned(patch.n);
    patch.n = normalised(n - dot(n, patch.a) * patch.a);
    patch.b = cross(patch.a, patch.n);
}

SurfacePatch patch_with_normal(const Vec3d& place, const Vec3d& normal)
{
    return patch_with_axis(place, unit_across(normal), normal);
}

SurfacePatch patch_with_axis(const Vec3d& place, const Vec3d& axis, const Vec3d& across)
{
    SurfacePatch patch;
    patch.place = place;
    patch.a = axis;
    patch.n = normalised(across - dot(across, axis) * axis);
    patch.b = cross(patch.a, patch.n);
    return patch;
}

bool lines_meet(const Vec3d& p, const Vec3d& np, const Vec3d& q, const Vec3d& nq, Vec3d& on_p)
{
    const Vec3d w = p - q;
    const double c = dot(np, nq), sine = dot(cross(np, nq), cross(np, nq));
    if (!(sine > 1e-12)) return false;
    const double dp = dot(np, w), dq = dot(nq, w);
    on_p = p + ((c * dq - dp) / sine) * np;
    return true;
}

}  // namespace models
}  // namespace pcm
