// Converts radii and normals of any type to the floats that the shaders read.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/point_batch.h"

#include <vector>

namespace pcm {

// Larger radii are clamped to this, whose square is still finite in float.
inline constexpr float largest_vertex_radius = 1e18f;

// One float per point: raw * scale + offset. NaN and values that are not positive become 0: such a splat is invisible
// unless its mode draws every point at least one pixel large. Returns the largest.
float make_radii(const Column& column, const Attribute& attribute, std::vector<float>& radii);

// Three floats per point: raw * scale + offset, normalised to length 1. (0, 0, 0) where that is zero or not finite;
// such a disc faces the eye. `column` has at least three components.
void make_normals(const Column& column, const Attribute& attribute, std::vector<float>& normals);

}  // namespace pcm
