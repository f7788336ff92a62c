// How much a curved surface is curved where it has points.
#pragma once

#include "pcm/shapes/shape.h"

#include <vector>

namespace pcm {

// The angle between the shape's normals at the two of the points where they differ most, radians, 0 to pi: of the
// normal that differs most from the first one's, and the one that differs most from that. 0 for no points.
double turn_of(const Shape& shape, const std::vector<Vec3d>& points);

// How far a curved shape rises over its chord at a place where normals turn by this angle in total: the sagitta of a
// circle, r (1 - cos(turn / 2)). A plane through such points is within half of it of all of them. Source units; 0 for a
// plane.
double sagitta_of(const Shape& shape, double turn);

}  // namespace pcm
