#include "plugin/host/picker.h"

#include "pcm/cloud/matrix.h"
#include "pcm/cloud/vector.h"
#include "plugin/host/view_camera.h"

#include <meshlab/glarea.h>

#include <cmath>

namespace pcm::host {

namespace {

constexpr double tolerance_px = 4;

Vec3d image_of(const Matrix4d& m, const Vec3d& p)
{
    Vec3d q;
    for (std::size_t r = 0; r < 3; ++r) q[r] = m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
    return q;
}

// What a pixel sees, in the scene's coordinates less the origin.
std::optional<Region> beam_of(const Camera& camera, double x, double y, const Vec3d& origin)
{
    const auto back = affine_inverse(camera.modelview);
    if (!back) return std::nullopt;
    const Matrix4d& p = camera.projection;
    const double u = 2 * x / camera.width - 1, v = 1 - 2 * y / camera.height;
    const bool parallel = p[11] == 0;
    const Vec3d eye = parallel ? Vec3d{(u - p[12]) / p[0], (v - p[13]) / p[5], 0} : Vec3d{0, 0, 0};
    const Vec3d ahead = parallel ? Vec3d{0, 0, -1} : Vec3d{(u + p[8]) / p[0], (v + p[9]) / p[5], -1};
    const Vec3d from = image_of(*back, eye), to = image_of(*back, eye + ahead);
    const double radius = tolerance_px * 2 / (camera.height * p[5]);
    if (parallel) return Region::ray(origin + from, to - from, radius);
    return Region::cone(origin + from, to - from, std::atan(radius) * 180 / pi);
}

}  // namespace

void pick(GLArea& area, const QPoint& place, QObject&, const std::function<void(const PickAnswer&)>& answer)
{
    PickAnswer result;
    result.message = "No point within 4 pixels of the cursor";
    const auto camera = camera_of(area);
    const double ratio = area.devicePixelRatioF();
    double nearest = std::numeric_limits<double>::infinity();
    for (MeshModel* layer : area.md()->meshList) {
        const auto tree = Registry::instance().drawn(*layer);
        if (!tree || !camera) continue;
        const auto beam = beam_of(*camera, (place.x() + 0.5) * ratio, (place.y() + 0.5) * ratio, tree->origin);
        if (!beam) continue;
        const HitResult hit = tree->cloud->first_hit(*beam);
        if (!hit.hit || !(hit.hit->along < nearest)) continue;
        nearest = hit.hit->along;
        Picked picked;
        picked.mesh_id = layer->id();
        picked.cloud = tree->cloud;
        picked.node = hit.hit->node;
        picked.point = hit.hit->index;
        picked.position = picked.shown_at = hit.hit->position;
        result.point = picked;
        result.message.clear();
    }
    answer(result);
}

}  // namespace pcm::host
