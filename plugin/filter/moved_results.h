// How results are shown that lie elsewhere than the clouds that they are made of.
#pragma once

#include "plugin/filter/operation_filter.h"

namespace pcm::host {

// In place of the layer that shows the first input, whose matrix is applied.
OperationHooks shown_as_moved();
// Replaces the visible layers, which are merged where the script chooses that.
OperationHooks shown_as_merged();

}  // namespace pcm::host
