// Distances of many points from a shape: for growth, detection and scores.
#pragma once

#include "pcm/shapes/shape.h"

#include <cstddef>

namespace pcm {

// As signed_distance() of each point, by plain formulas: to about 1e-15 of the largest number among coordinates and
// radius, so coordinates should be relative to a place near the points, and the shape in the same coordinates. The
// side of a cone beyond its apex is measured like its own surface, not from the apex.
void signed_distances(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count,
                      double* out);

}  // namespace pcm
