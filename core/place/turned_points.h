// Points of a curved shape that their own station cannot have seen there: the surface is turned away from it.
//
// A beam at the silhouette of a pipe hits what is behind it, too, and its point lies next to the pipe or behind its
// edge. A few such points make the arc of a pipe that is seen from one side look longer than it is: they move its axis
// and radius, and its errors come out at half of what they are.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/shapes/primitive.h"

#include <vector>

namespace pcm {

// Those of a curved shape that face their stations (place.facing.min_cosine). The direction to a station is about the
// mean normal of its points; all points are kept of stations that show none (station_rays.h).
std::vector<PointOfStation> facing_points(const Shape& shape, const std::vector<PointOfStation>& points);

// Moves the shape of `fit` by what its fit to `points` would be moved by without the others of `all`, a sample of its
// points. Its errors become no less than those of `points`, enlarged by `alike` because neighbours share errors, and
// contain half of that way. `points`: a part of `all`.
void leave_turned_points(const std::vector<PointOfStation>& points, const std::vector<PointOfStation>& all,
                         double alike, ShapeFit& fit);

}  // namespace pcm
