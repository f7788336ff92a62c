// The outline of points in a plane that follows wide gaps.
#pragma once

#include "pcm/shapes/flat_points.h"

#include <cstdint>
#include <vector>

namespace pcm {

// A simple polygon with all points inside or on it, counter-clockwise, as places in `points`: from the convex hull,
// triangles of the Delaunay triangulation are taken away through border edges longer than `edge`, the longest first,
// as long as the polygon stays one piece without holes (Duckham, Kulik, Worboys, Galton 2008). The unit of `edge` is
// that of the points; 0: three times the median of the triangles' longest sides. Three points or more that are not all
// on one line; O(n log n) time, about 150 bytes per point.
std::vector<std::uint32_t> concave_outline(const FlatPoints& points, double edge);

}  // namespace pcm
