// Lengths that dialogs propose: those of the current layer's cloud.
#pragma once

#include "plugin/scene/parameters.h"
#include "plugin/scene/scene.h"

namespace pcm::host {

// Gives each parameter that is a spacing that of the finest level of detail of the current layer's tree, as a round
// number (core/system/round_number.h): there thinning and voxels begin to do something. As they are where no layer is
// current, it shows no tree, or its tree has no level that is thinner than the cloud.
void propose_spacing(Parameters& parameters, const Scene& scene);

}  // namespace pcm::host
