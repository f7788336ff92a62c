// How far points of the surfaces next to a strip may have turned its plane.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/fit/shape_fit.h"

#include <vector>

namespace pcm {

// Standard deviation of points along the direction in which those of a plane are spread least. 0: no points.
double narrowest_spread(const std::vector<Vec3d>& points);

// Angle, radians, by which two surfaces turn a strip's plane of least squares. They meet the strip at its two long
// borders, one leads up and the other down, and they have as many points per area as the strip:
// 6 t^2 / (w^2 + 6 t w), t: threshold, w: width of the strip if its points are spread evenly. Holds for small angles.
// `points`: points of the plane, source coordinates.
double turn_of_strip(const std::vector<Vec3d>& points, double threshold);

// Doubts a plane whose points are a strip so narrow that the surfaces next to it may have turned it by more than
// place.following.max_strip_turn. For planes that were fitted to points next to these surfaces, too.
void doubt_strip(const std::vector<Vec3d>& points, ShapeFit& fit);

}  // namespace pcm
