// Turns MeshLab's camera to a part of the scene. GUI thread.
#pragma once

#include "pcm/cloud/geometry.h"

class GLArea;

namespace pcm::host {

// The box fills this part of the view's height, or a ball of `least_radius` about its middle does, where that is
// larger. The direction of view stays. Nothing happens for an empty box.
void look_at(GLArea& view, const Box3d& box, double filled, double least_radius = 0);

}  // namespace pcm::host
