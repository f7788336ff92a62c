// Which points of a layer a view shows. GUI thread.
#pragma once

#include "pcm/query/query.h"

#include <common/interfaces.h>

#include <vector>

class GLArea;

namespace pcm::host {

// The conditions that views apply to a cloud of this schema.
std::vector<Condition> applicable(const std::vector<Condition>& where, const Schema& schema);

// The view's clip box, hidden classes and conditions, for the layer's cloud; like in the picture, conditions on what
// the cloud does not have are left out.
Query shown_points(GLArea& view, const MeshModel& layer);

// The layers that the view shows as clouds.
std::vector<MeshModel*> shown_layers(GLArea& view);

}  // namespace pcm::host
