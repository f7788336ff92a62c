#include "plugin/edit/scene_bounds.h"

#include "plugin/host/placement.h"
#include "plugin/host/registry.h"
#include "plugin/host/trackball_pose.h"
#include "plugin/host/view_box.h"

#include <meshlab/glarea.h>

namespace pcm::host {

namespace {

Box3d moved(const Box3d& box, const MeshModel& layer)
{
    const auto tree = Registry::instance().drawn(layer);
    const auto placement = tree ? placement_of(layer, *tree) : std::nullopt;
    if (!placement || box.empty()) return box;
    Box3d result;
    for (int corner = 0; corner < 8; ++corner)
        result.extend(
            (*placement)({(corner & 1) != 0 ? box.max[0] : box.min[0], (corner & 2) != 0 ? box.max[1] : box.min[1],
                          (corner & 4) != 0 ? box.max[2] : box.min[2]}));
    return result;
}

}  // namespace

Box3d bounds_of(const MeshModel& layer)
{
    const auto tree = Registry::instance().drawn(layer);
    return tree ? moved(tree->cloud->info().bounds(), layer) : Box3d();
}

Box3d bounds_of_shown(GLArea& view)
{
    Box3d bounds;
    for (const MeshModel* layer : view.md()->meshList)
        if (layer && view.meshVisibilityMap.value(layer->id(), true)) bounds.extend(bounds_of(*layer));
    return bounds;
}

Box3d bounds_in_picture(GLArea& view)
{
    Box3d bounds;
    const EyePose pose = pose_of(view.trackball.track, view.fov);
    const double aspect = double(view.width()) / std::max(1, view.height());
    for (const MeshModel* layer : view.md()->meshList) {
        if (!layer || !view.meshVisibilityMap.value(layer->id(), true) || !Registry::instance().drawn(*layer)) continue;
        if (const auto seen = box_in_view(*layer, pose, view.fov, aspect)) bounds.extend(moved(*seen, *layer));
    }
    return bounds;
}

double grid_step_of_shown(const GLArea& view)
{
    double step = 0;
    for (const MeshModel* layer : const_cast<GLArea&>(view).md()->meshList) {
        const auto tree = layer && view.meshVisibilityMap.value(layer->id(), true) ? Registry::instance().drawn(*layer)
                                                                                   : std::nullopt;
        if (!tree) continue;
        for (const double scale : tree->cloud->info().grid.scale)
            if (scale > 0 && (step == 0 || scale < step)) step = scale;
    }
    return step;
}

}  // namespace pcm::host
