// Whether the stations of a scanner see a plane from two sides: then it is the middle of a plate, whose faces lie
// within its threshold. A station sees one face of it, so the mean distances of the stations' points fall in two
// groups, which are farther apart than the registration leaves stations.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/shapes/shape.h"

#include <vector>

namespace pcm {

// Lengths in source units.
struct StationSides {
    double apart = 0;   // distance between the means of the groups
    double gap = 0;     // the same between the nearest stations of both
    double within = 0;  // standard deviation of the points of a station
    double share = 0;   // share of the points that the smaller group has

    // Standard deviations: `noise` is that of points on smooth surfaces around, 0: unknown; `spread` that of stations
    // along each axis, from other surfaces.
    bool are_two(double noise, double spread) const;
};

// Stations of few points do not count; fewer than two give all zeros.
StationSides station_sides(const Shape& plane, const std::vector<PointOfStation>& points);

}  // namespace pcm
