// How far it is from the eye to what a view shows, for the speed of walking.
#pragma once

#include "pcm/cloud/geometry.h"

class GLArea;

namespace pcm::host {

struct SceneReach {
    double distance = 1;  // to the nearest points; within bounds that the size of the document sets, so never 0
    double error = 0;     // so much nearer the nearest may be
};

// Of the layers that the view shows, from a place in the document's coordinates. Trees: the points that memory has,
// else the boxes of nodes (view/clearance.h). Meshes: their box, and inside of it a twentieth of its diagonal. Reads
// nothing and waits for nothing.
SceneReach reach_from(GLArea& view, const Vec3d& place);

// Whether the view's document shows clouds, whose heights are along z as a rule; meshes have y for it in MeshLab.
bool shows_clouds(GLArea& view);

}  // namespace pcm::host
