// The points that a shape was fitted to, of those that belong to it.
#pragma once

#include "pcm/place/fit_at.h"

namespace pcm {

// The points of a shape without straight pipes that continue it. Streams. Throws Error(cancelled), and what reading
// throws.
PointSet own_points(const FittedPrimitive& found, unsigned threads, const ProgressFunction& progress = {});

}  // namespace pcm
