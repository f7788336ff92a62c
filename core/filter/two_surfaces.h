// Points whose neighbours lie on two surfaces: both sides of a thin plate, or surfaces that nearly touch.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/filter/point_values.h"

namespace pcm {

// Whether a point and its neighbours lie on two parallel sheets, one above the other: two planes with a gap of at least
// six times what is left of their heights, whose points are mixed as seen along the normal (a step, an edge and a
// curved surface have their heights in different places). `normal`: unit normal of all these points.
// `least_gap`: minimum distance of the sheets, source units: rounding of positions makes sheets, too. Never with fewer
// than 9 neighbours, which are too few.
//
// Measured on random plates (16 neighbours, joined with the answers of six neighbours each, orientation_pieces.h): of
// plates up to half as thick as their points are apart, with noise up to a tenth of that, 80 to 90 % are found; of
// thicker ones fewer, from the spacing on hardly any. For single surfaces with normal or uniform noise, waves, steps
// and lattices at most 0.4 %.
bool are_two_surfaces(const OnePointsNeighbours& neighbours, const Vec3d& normal, double least_gap);

// Whether a neighbour at an offset lies across a gap rather than next to the point: more than 30 degrees out of the
// surface.
inline bool is_across(const Vec3d& offset, const Vec3d& normal)
{
    const double up = dot(offset, normal);
    return up * up > 0.25 * dot(offset, offset);
}

}  // namespace pcm
