// The polygon of a plane that there is: where a box cuts the plane, or around points.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/shapes/bounds.h"

#include <vector>

namespace pcm::shapes {

// Corners as ShapeBounds::outline has them; see bounds_in_box() and bounds_of() for both.
std::vector<Vec3d> plane_in_box(const Shape& plane, const Box3d& box);
std::vector<Vec3d> outline_of_points(const Shape& plane, const std::vector<Vec3d>& inliers,
                                     const OutlineOptions& options);

}  // namespace pcm::shapes
