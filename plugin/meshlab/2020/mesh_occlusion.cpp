#include "plugin/meshlab/2020/mesh_occlusion.h"

#include "plugin/meshlab/2020/meshlab.h"

#include "pcm/cloud/vector.h"

#include <cmath>

namespace pcm::host {

namespace {

Vec3d vector_of(const Point3m& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

bool is_surface(GLArea& area, const MeshModel& layer)
{
    if (layer.cm.fn == 0 || !area.meshVisibilityMap.value(layer.id(), true)) return false;
    MLSceneGLSharedDataContext* const shared = area.mvc() ? area.mvc()->sharedDataContext() : nullptr;
    if (!shared) return false;
    MLRenderingData data;
    shared->getRenderInfoPerMeshView(layer.id(), area.context(), data);
    return data.isPrimitiveActive(MLRenderingData::PR_SOLID);
}

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

Occluder find_occluder(GLArea& area, const PickRay& ray)
{
    Occluder nearest;
    for (const MeshModel* layer : area.md()->meshList) {
        if (!layer || !is_surface(area, *layer)) continue;
        Affine matrix;
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) matrix.linear[std::size_t(r)][std::size_t(c)] = double(layer->cm.Tr[r][c]);
            matrix.target[std::size_t(r)] = double(layer->cm.Tr[r][3]);
        }
        const auto own = ray.before(matrix);
        if (!own) continue;
        const Vec3d from = own->centre + own->start;
        for (const CFaceO& face : layer->cm.face) {
            if (face.IsD()) continue;
            const double t = along_to_face(own->direction, vector_of(face.cP(0)) - from, vector_of(face.cP(1)) - from,
                                           vector_of(face.cP(2)) - from);
            const double along = t / own->scale * ray.scale;
            if (!(t >= own->begin && t <= own->end) || !(along < nearest.along)) continue;
            nearest.along = along;
            nearest.layer = layer->label();
        }
    }
    return nearest;
}

}  // namespace pcm::host
