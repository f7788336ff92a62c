// Shapes in words for lists, logs and command lines.
#pragma once

#include "pcm/shapes/fitted_shape.h"

#include <string>

namespace pcm {

// Where a shape is, with the digits that are known: "cylinder through 40.000 20.000 96.002, axis 0.00001
// 0.00001 1.00000"
std::string place_text(const ShapeFit& fit);

}  // namespace pcm
