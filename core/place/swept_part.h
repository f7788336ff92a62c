// The part of a torus whose cross sections lie on it: an elbow without the straight pipes at its ends.
//
// Where a straight pipe leaves an elbow of radius R at the tangent, its axis is s^2 / (2 R) from the elbow's at a way s
// beyond. As long as that is within the threshold its points are reached, all of them on one side of the elbow.
#pragma once

#include "pcm/shapes/shape.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

// A range of the angle about the axis, counted from `begin`, radians.
struct SweptPart {
    Shape shape;       // the sweep, fitted to the part
    double begin = 0;  // the middle of the gap that the torus leaves
    double from = 0, to = 0;
    bool has(const Vec3d& p) const;
};

// The part of a torus whose cross sections have its centre and radius; nothing where all of the points are on it, where
// less than two fifths of them would be left, and for other kinds. Each slice around the axis gets an offset of its
// centre and radius by least squares. From the half that fits the shape best, the part grows as long as these offsets
// are chance: chi-square of three degrees of freedom, in units of its mean in that half. Nothing where that mean is
// large, as where neighbours share errors. `points`: on the shape, source coordinates, spread evenly; `noise`: one
// standard deviation of their distances, above 0; `threshold`: as in RefineOptions; both in source units. One thread.
std::optional<SweptPart> swept_part(const Shape& shape, double noise, double threshold,
                                    const std::vector<Vec3d>& points);

}  // namespace pcm
