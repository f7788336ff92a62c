#include "plugin/scene/scene.h"

#include "plugin/scene/scene_view.h"
#include "plugin/scene/view_box.h"

#include <algorithm>
#include <utility>

namespace pcm::host {

void Scene::repaint() const
{
    for (SceneView* view : views()) view->update();
}

std::optional<Box3d> SceneView::seen_box(const SceneLayer& layer) const
{
    const ViewPose look = pose();
    return box_in_view(layer, look.pose, look.fov, double(size().width()) / std::max(1, size().height()));
}

void SceneView::keep(const Camera& camera, ShownClouds shown)
{
    camera_ = camera;
    shown_ = std::move(shown);
}

}  // namespace pcm::host
