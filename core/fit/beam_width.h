// What the width of a scanner's beam does to a curved shape.
//
// A scanner measures the mean distance of what its beam lights up. With w^2 the variance of the beam's light along each
// of two directions across it, H the second derivatives of a place's distance from the surface, n the surface's normal,
// u the direction of the ray and q1, q2 two unit vectors across it that are moved along it onto the surface, q - u
// (n.q) / (n.u), a point lies at the distance
//
//     -w^2 (q1' H q1 + q2' H q2) / 2
//
// from the surface: behind it where it is convex, by w^2 / (2 r cos^2) on a pipe of radius r that is seen at an angle
// whose cosine is cos. So w^2 is one more number of the fit, which the points' distances show where a thin pipe turns
// away. Each station is shifted freely meanwhile, since shifts bend distances, too; and before any point is seen, w^2
// is 0 with the standard deviation `widest`^2, because a large shape does not show it.
#pragma once

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/station_rays.h"

#include <array>
#include <cstdint>
#include <map>

namespace pcm {

struct BeamWidth {
    double variance = 0;  // w^2, the most probable one, at least 0; square of the extent's unit
    double error = 0;     // its standard deviation
    // Sum over the points of the derivatives of the distance by the shape's parameters, times how far they lie from the
    // surface where the variance is 1: what it adds to the right side of the normal equations.
    std::array<double, most_parameters> pulls{};
};

// `patch`: the shape in units of the extent, about the middle, as the points are; `widest`: above 0, in these units;
// `step`: length of the differences that stand for derivatives. One thread; a microsecond a point.
BeamWidth beam_width(const ShapeModel& model, const SurfacePatch& patch,
                     const std::map<std::uint32_t, StationRays>& stations, double widest, double step);

}  // namespace pcm
