// Points of a curved shape that their own station cannot have seen there: the surface is turned away from it.
//
// A beam at the silhouette of a pipe hits what is behind it, too, and its point lies next to the pipe or behind its
// edge. A few such points make the arc of a pipe that is seen from one side look longer than it is: they move its axis
// and radius, and its errors come out at half of what they are.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/shapes/primitive.h"

#include <cstdint>
#include <map>
#include <vector>

namespace pcm {

// The directions to the stations of a curved shape: that to a station is about the mean normal of its points. Any
// number of threads.
class StationDirections {
public:
    // `points`: a sample of the shape's.
    StationDirections(const Shape& shape, const std::vector<PointOfStation>& points);

    // Whether the shape faces the station there (place.facing.min_cosine). True for all points of stations whose points
    // show no direction (station_rays.h). `p`: source coordinates.
    bool can_see(const Vec3d& p, std::uint32_t station) const;

private:
    Shape shape_;
    std::map<std::uint32_t, Vec3d> directions_;  // unit vectors, keyed by station
};

// The points that their stations can see.
std::vector<PointOfStation> facing_points(const StationDirections& directions,
                                          const std::vector<PointOfStation>& points);

// Moves the shape of `fit` by what its fit to `points` would be moved by without the others of `all`, a sample of its
// points. Its errors become no less than those of `points`, enlarged by `alike` because neighbours share errors, and
// contain half of that way. Doubts a good fit whose size is then uncertain; where it would be moved to a radius below
// 0, or the like, it keeps its shape, and its errors contain all of the way. `points`: a part of `all`.
void leave_turned_points(const std::vector<PointOfStation>& points, const std::vector<PointOfStation>& all,
                         double alike, ShapeFit& fit);

}  // namespace pcm
