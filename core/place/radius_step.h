// Where the radius of a pipe changes: a reducer, behind which a narrower pipe continues on the same axis. Seen from one
// side, both lie within the threshold of one slightly turned cylinder.
#pragma once

#include "pcm/shapes/shape.h"

#include <optional>
#include <vector>

namespace pcm {

struct RadiusStep {
    // Ways along the axis from the cylinder's point, source units, between which the radius is that at the place,
    // without the slices next to where it changes; infinite where it does not.
    double from = 0, to = 0;
    double radius = 0, beyond = 0;  // at the place, and behind the step; source units
    bool has_place = false;         // false: the radius changes at the place, or next to it
};

// The interval about the place whose radius, unlike that of the rest, explains the radii of slices across the axis
// best, each a circle fitted to some of the points. Nothing where they differ by less than `least`, where that explains
// little of how slices differ, as of a cone's, or is chance. `points`: on the cylinder, source coordinates; `noise`:
// their standard deviation, above 0, source units. One thread; a millisecond for 4,000 points.
std::optional<RadiusStep> radius_step(const Shape& cylinder, double noise, double least, const Vec3d& place,
                                      const std::vector<Vec3d>& points);

}  // namespace pcm
