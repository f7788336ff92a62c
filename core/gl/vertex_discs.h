// Turns radii and normals of any type into the floats that the rasteriser reads.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/point_batch.h"

#include <vector>

namespace pcm {

// Radii beyond this are taken as this: their squares are still floats.
inline constexpr float largest_vertex_radius = 1e18f;

// One float a point: raw * scale + offset. What is not a positive number is 0, a splat that is not seen unless the mode
// draws every point at least one pixel large. Returns the largest.
float make_radii(const Column& column, const Attribute& attribute, std::vector<float>& radii);

// Three floats a point, of length 1 whatever the length of (raw * scale + offset) is; (0, 0, 0) for one that is zero or
// no number, which is drawn facing the eye. `column` has at least three components.
void make_normals(const Column& column, const Attribute& attribute, std::vector<float>& normals);

}  // namespace pcm
