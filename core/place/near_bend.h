// Where a pipe bends near a place: an elbow leaves its pipe's cylinder by s^2 / (2 R) at a way s beyond the tangent, on
// one side, by less than the noise for some way.
#pragma once

#include "pcm/shapes/shape.h"

#include <optional>
#include <vector>

namespace pcm {

struct NearBend {
    // Way along the axis from the place to the beginning of the bend, source units. Below 0: the place lies on the
    // bend.
    double start = 0;
    double least_start = 0;  // least way, of a bend along the axis or against it, that the points allow at three
                             // deviations; -infinity: all of them
    double radius = 0;       // radius of the bend's axis
    Vec3d direction{};       // along the pipe's axis, to the bend
    double evidence = 0;     // logarithm of the likelihood ratio of the bent pipe to the straight one
};

// Straight cylinder near a place.
struct PipeAtPlace {
    Shape cylinder;
    double threshold = 0;  // maximum distance of its points, above 0, source units
    double noise = 0;      // their standard deviation, above 0, source units
    Vec3d place{};
};

// Way along the axis in which points show whether a bend begins at the place: twice as far as the sides of an elbow,
// whose radius is three times that of its tube, stay within around_thresholds of the cylinder.
double reach_of_bends(const PipeAtPlace& pipe);

// The bend along the axis or against it, whichever explains the points better. Least squares of cylinders with and
// without a bend, of which the beginning is anywhere within the reach; distances count up to three standard deviations.
// Nothing where a bend of a radius above the pipe's does not explain the points better than a straight pipe by
// place.kinds.min_evidence. Where neighbours share errors about the bent pipe, the number of points is that of
// independent points. `points`: on the cylinder and around it, source coordinates; those out of reach are ignored. One
// thread; some tens of milliseconds for 1000 points.
std::optional<NearBend> bend_near(const PipeAtPlace& pipe, const std::vector<Vec3d>& points);

// A point far along the bend near `place`, where it is no longer within the noise of the pipe: a tenth of the points
// are farther. Nothing where none of the points is on it.
std::optional<Vec3d> place_on(const NearBend& bend, const Vec3d& place, const std::vector<Vec3d>& points);

}  // namespace pcm
