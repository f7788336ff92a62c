// A shape of least squares, from one that is near.
#pragma once

#include "pcm/shapes/shape.h"

#include <optional>
#include <vector>

namespace pcm {

// Nothing where the points within the threshold do not determine it. `threshold`: source units.
std::optional<Shape> refined_shape(const std::vector<Vec3d>& points, const Shape& start, double threshold);

}  // namespace pcm
