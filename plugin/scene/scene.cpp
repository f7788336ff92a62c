#include "plugin/scene/scene.h"

#include "plugin/scene/scene_view.h"

#include <utility>

namespace pcm::host {

void Scene::repaint() const
{
    for (SceneView* view : views()) view->update();
}

void SceneView::keep(const Camera& camera, ShownClouds shown)
{
    camera_ = camera;
    shown_ = std::move(shown);
}

}  // namespace pcm::host
