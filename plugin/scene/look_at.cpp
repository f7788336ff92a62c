#include "plugin/scene/look_at.h"

#include "pcm/cloud/vector.h"
#include "plugin/scene/scene_bounds.h"
#include "plugin/scene/scene_view.h"

#include <algorithm>

namespace pcm::host {

namespace {

// MeshLab's view spans 1.75 of the trackball's units above and below its centre (meshlab/trackball_pose.h).
constexpr double shown_radius = 1.75;

}  // namespace

void look_at(SceneView& view, const Box3d& box, double filled, double least_radius)
{
    if (box.empty()) return;
    const double all = bounds_of_shown(view).diagonal();
    double radius = std::max(box.diagonal() / 2, least_radius);
    if (!(radius > 0)) radius = all > 0 ? all / 100 : 1;
    view.look_at(box.centre() - view.scene().origin().value_or(Vec3d{}), filled * shown_radius / radius);
}

}  // namespace pcm::host
