// Shapes of so few points that they may be a leaf.
#pragma once

#include "pcm/place/fit_at.h"

namespace pcm {

// Doubts a good shape whose neighbourhood was chosen by its noise, and which has fewer points than leaves and twigs
// that look smooth (place.following.min_narrow_points).
void doubt_few_points(FittedPrimitive& result);

// Doubts a good shape whose few points are within the size of a leaf (place.following.min_small_points, max_small).
// Reads these points, streams. `threads`: 0: one per processor. Throws what reading throws.
void doubt_small(FittedPrimitive& result, double metres_per_unit, unsigned threads);

}  // namespace pcm
