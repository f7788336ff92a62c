// Whether a shape was fitted already. Any thread.
#pragma once

#include "pcm/shapes/primitive_list.h"

#include <cstddef>
#include <optional>

namespace pcm::host {

// The first primitive of the list that is the same surface as this one: of the same kind and cloud, where most of both
// outlines lies on the other's surface (within the larger of the two thresholds), and most of the extents overlap.
std::optional<std::size_t> same_shape(const PrimitiveList& list, const Primitive& primitive);

}  // namespace pcm::host
