#include "plugin/meshlab/mesh_occlusion.h"

#include "pcm/cloud/vector.h"
#include "plugin/meshlab/native_drawing.h"
#include "plugin/scene/layer_matrix.h"

#include <cmath>

namespace pcm::host {

namespace {

// Möller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997. Corners are relative to the ray's start.
// Slightly larger triangles leave no gap between neighbours.
double along_to_face(const Vec3d& direction, const Vec3d& a, const Vec3d& b, const Vec3d& c)
{
    constexpr double none = std::numeric_limits<double>::infinity(), spare = 1e-12;
    const Vec3d ab = b - a, ac = c - a, p = cross(direction, ac);
    const double determinant = dot(ab, p);
    if (determinant == 0) return none;
    const double u = -dot(a, p) / determinant;
    if (!(u >= -spare && u <= 1 + spare)) return none;
    const Vec3d q = cross(ab, a);
    const double v = dot(direction, q) / determinant;
    // With s = -a: q is s x ab = ab x a.
    if (!(v >= -spare && u + v <= 1 + spare)) return none;
    return dot(ac, q) / determinant;
}

}  // namespace

Occluder find_occluder(const SceneView& view, const PickRay& ray)
{
    Occluder nearest;
    for (const SceneLayer* layer : view.scene().layers()) {
        if (!draws_faces(view, *layer)) continue;
        const auto own = ray.before(map_of(layer->matrix(), {0, 0, 0}));
        if (!own) continue;
        const Vec3d from = own->centre + own->start;
        visit_faces(*layer, [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
            const double t = along_to_face(own->direction, a - from, b - from, c - from);
            const double along = t / own->scale * ray.scale;
            if (!(t >= own->begin && t <= own->end) || !(along < nearest.along)) return;
            nearest.along = along;
            nearest.layer = layer->label();
        });
    }
    return nearest;
}

}  // namespace pcm::host
