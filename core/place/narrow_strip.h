// How far points of the surfaces next to a strip may have turned its plane.
#pragma once

#include "pcm/shapes/shape.h"

#include <vector>

namespace pcm {

// Standard deviation of points along the direction in which those of a plane are spread least. 0: no points.
double narrowest_spread(const std::vector<Vec3d>& points);

// Angle, radians, by which two surfaces across the two long borders of a strip turn the plane of least squares if one
// leads away to its one side and the other to its other side, and both have as many points per area as the strip has:
// 6 t^2 / (w^2 + 6 t w), with the maximum distance t of the plane's points and the width w of a strip of even density
// that has their narrowest spread. For small angles. `points`: those of the plane, source coordinates.
double turn_of_strip(const std::vector<Vec3d>& points, double threshold);

}  // namespace pcm
