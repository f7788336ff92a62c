// The first stage of a build: points are read once and distributed to bins on disk that are small enough to work on in
// memory.
#pragma once

#include "pcm/build/build_state.h"

namespace pcm {

// Reads the cloud to its end. Sets what `state` holds of reading. Positions get the cloud's grid where it has one, or
// one that is fine enough for all its doubles.
AnyBins partition(PointReader& cloud, BuildState& state);

}  // namespace pcm
