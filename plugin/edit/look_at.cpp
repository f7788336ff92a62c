#include "plugin/edit/look_at.h"

#include "pcm/cloud/vector.h"
#include "plugin/edit/scene_bounds.h"
#include "plugin/host/registry.h"

#include <meshlab/glarea.h>

#include <algorithm>

namespace pcm::host {

namespace {

// MeshLab's view spans 1.75 of the trackball's units above and below its centre (host/trackball_pose.h).
constexpr double shown_radius = 1.75;

}  // namespace

void look_at(GLArea& view, const Box3d& box, double filled, double least_radius)
{
    if (box.empty()) return;
    const double all = bounds_of_shown(view).diagonal();
    double radius = std::max(box.diagonal() / 2, least_radius);
    if (!(radius > 0)) radius = all > 0 ? all / 100 : 1;
    const Vec3d centre = box.centre() - Registry::instance().origin_of(*view.md()).value_or(Vec3d{});
    auto& track = view.trackball.track;
    track.sca = static_cast<float>(filled * shown_radius / radius);
    track.tra = vcg::Point3f(float(-centre[0]), float(-centre[1]), float(-centre[2]));
    view.update();
}

}  // namespace pcm::host
