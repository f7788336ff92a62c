// Turns MeshLab's camera to a part of the scene. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

#include "pcm/cloud/geometry.h"

namespace pcm::host {

// The box fills this part of the view's height, or a ball of `least_radius` about its middle does, where that is
// larger. The direction of view stays. Nothing happens for an empty box.
void look_at(SceneView& view, const Box3d& box, double filled, double least_radius = 0);

}  // namespace pcm::host
