// Where the clouds of a document are in its scene (scene/annotations.h). GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

#include "pcm/cloud/geometry.h"

namespace pcm::host {

// The box around a layer's cloud; empty for a layer that is not drawn as a cloud.
Box3d bounds_of(const SceneLayer& layer);
// The box around all clouds that the view shows.
Box3d bounds_of_shown(SceneView& view);
// The box around the parts of clouds that the picture of the view has, about as close as the size of a chunk.
Box3d bounds_in_picture(SceneView& view);
// The finest step of the grids of the clouds that the view shows, source units; 0: it shows none.
double grid_step_of_shown(const SceneView& view);

}  // namespace pcm::host
