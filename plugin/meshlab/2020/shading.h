// How MeshLab draws the points of an ordinary layer.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

namespace pcm::host {

// Draws the layer's points in their own colours, without light, in all views. MeshLab also shades points without
// normals, which makes them dark. Does nothing without a window.
void draw_unshaded(MeshModel& layer);

}  // namespace pcm::host
