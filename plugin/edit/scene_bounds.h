// Where the clouds of a document are in its scene (host/annotations.h). GUI thread.
#pragma once

#include "pcm/cloud/geometry.h"

#include <common/interfaces.h>

class GLArea;

namespace pcm::host {

// Around a layer's cloud; empty for a layer that is not drawn as a cloud.
Box3d bounds_of(const MeshModel& layer);
// Around all clouds that the view shows.
Box3d bounds_of_shown(GLArea& view);
// Around the parts of clouds that the picture of the view has, about as close as the size of a chunk.
Box3d bounds_in_picture(GLArea& view);
// The finest step of the grids of the clouds that the view shows, source units; 0: it shows none.
double grid_step_of_shown(const GLArea& view);

}  // namespace pcm::host
