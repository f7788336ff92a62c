// Whether the stations of a scanner see a plane from two sides: then it is the middle of a plate, whose faces lie
// within its threshold. A station sees one face of it, so the mean distances of the stations' points fall in two
// groups, which are farther apart than the registration leaves stations.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/shapes/shape.h"

#include <cstdint>
#include <vector>

namespace pcm {

// Lengths in source units.
struct StationSides {
    double apart = 0;                         // distance between the means of the groups
    double gap = 0;                           // the same between the nearest stations of both
    double within = 0;                        // standard deviation of the points of a station
    double share = 0;                         // share of the points that the smaller group has
    double left = 1;                          // share of the stations' variance that is left within the groups
    std::vector<std::uint32_t> below, above;  // stations of each group, along the plane's axis
    double middle = 0;                        // signed distance of the middle between the groups from the plane

    // Whether the groups are farther apart than noise and registration leave stations, or than one normal distribution
    // does: of n normal numbers the two best groups leave less than 0.014 (n - 3.5) of the variance once in a hundred
    // times. Standard deviations: `noise` is that of points on smooth surfaces around, 0: unknown; `spread` that of
    // stations along each axis, from other surfaces, which may be plates, too.
    bool are_two(double noise, double spread) const;
};

// Stations of few points do not count; fewer than two give all zeros.
StationSides station_sides(const Shape& plane, const std::vector<PointOfStation>& points);

}  // namespace pcm
