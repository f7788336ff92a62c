// Turns MeshLab's camera to what was measured. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

#include "pcm/measure/measure.h"

#include <vector>

namespace pcm::host {

// The points fill about a third of the view, or, where they are one place, some hundred times their spacing does. The
// direction of view stays.
void look_at(SceneView& view, const std::vector<MeasuredPoint>& points);

}  // namespace pcm::host
