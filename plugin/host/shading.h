// How MeshLab draws the points of an ordinary layer.
#pragma once

#include <common/interfaces.h>

namespace pcm::host {

// In all views: points show their colours as they are, without light. MeshLab shades points without normals too, which
// makes them dark. Does nothing without a window.
void draw_unshaded(MeshModel& layer);

}  // namespace pcm::host
