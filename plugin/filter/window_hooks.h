// What the window gives to operations and takes from them: layers, the clip box, selected points, primitives.
#pragma once

#include "plugin/filter/operation_filter.h"

namespace pcm::host {

OperationHooks at_points_of_layer();  // measure: the tree of the current layer, where the nearest points are asked for
OperationHooks on_selection();        // selected points of the current layer
OperationHooks fitting_primitives();  // fit
OperationHooks finding_primitives();  // detect
OperationHooks exporting_primitives();  // primitives

}  // namespace pcm::host
