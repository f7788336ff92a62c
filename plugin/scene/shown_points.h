// Which points of a layer a view shows. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

#include "pcm/query/query.h"

#include <vector>

namespace pcm::host {

// The conditions that views apply to a cloud of this schema.
std::vector<Condition> applicable(const std::vector<Condition>& where, const Schema& schema);

// The view's clip box, hidden classes and conditions, for the layer's cloud; like in the picture, conditions on what
// the cloud does not have are left out.
Query shown_points(SceneView& view, const SceneLayer& layer);

// The layers that the view shows as clouds.
std::vector<SceneLayer*> shown_layers(SceneView& view);

}  // namespace pcm::host
