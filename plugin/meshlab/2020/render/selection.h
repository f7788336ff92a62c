// MeshLab draws selected vertices before decorators, so that our points cover them. They are drawn once more on top.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

class GLArea;

namespace pcm::host {

// As MeshLab draws them in this view, if its button for that is on. The view's context is current.
void draw_selected_vertices(GLArea& area, MeshModel& layer);

}  // namespace pcm::host
