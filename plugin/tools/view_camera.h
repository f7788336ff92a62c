// The camera of a view, as tools use it: which pixel shows which place. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"
#include "plugin/scene/view_map.h"

#include <optional>

namespace pcm::host {

// The camera of the picture that the view shows, in the scene's coordinates; nothing until it has painted a cloud.
std::optional<ViewMap> map_of(const SceneView& view);

// For observers such as tests: the camera as the property pcm_camera of the view.
void publish_camera(SceneView& view);

}  // namespace pcm::host
