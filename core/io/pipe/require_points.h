// A selection that must not be empty: an output without points would replace a good one, or be taken for a result.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/io/reader.h"

#include <functional>
#include <memory>

namespace pcm {

// The same points. At the end, if there was none, read() throws Error(invalid_argument) with `cloud()`, the box of the
// points that could have been selected; an empty box means that there were none, which is not an error.
std::unique_ptr<PointReader> require_points(std::unique_ptr<PointReader> selected, std::function<Box3d()> cloud);

}  // namespace pcm
