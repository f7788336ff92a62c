// A shape of least squares, from one that is near.
#pragma once

#include "pcm/shapes/fitted_shape.h"

#include <optional>
#include <vector>

namespace pcm {

// Refused where the points within the threshold do not determine it. `threshold`: source units.
ShapeFit refined_fit(const std::vector<Vec3d>& points, const Shape& start, double threshold);

// Nothing where the points within the threshold do not determine it.
std::optional<Shape> refined_shape(const std::vector<Vec3d>& points, const Shape& start, double threshold);

}  // namespace pcm
