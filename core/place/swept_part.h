// The part of a torus that is bent: an elbow without the straight pipes at its ends.
//
// Where a straight pipe leaves an elbow of radius R at the tangent, its axis is s^2 / (2 R) from the elbow's at a way s
// beyond. As long as that is within the threshold its points are reached, all of them on one side of the elbow.
#pragma once

#include "pcm/shapes/shape.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

// A range of the angle about the axis, counted from `start`, radians.
struct SweptPart {
    Shape shape;    // the sweep, fitted to the part
    Vec3d start{};  // direction of the middle of the gap that the torus leaves
    double from = 0, to = 0;
    bool has(const Vec3d& p) const;
};

// The part of a torus between the straight tubes that continue it; nothing where these explain the points no better
// than the torus alone, where less than a tenth of the points would be left, and for other kinds. The ends are those of
// a bent tube that is fitted to all points around (bent_tube.h), moved inwards by a few of their errors; the shape is
// fitted to the points between them. `points`: on the shape, source coordinates, spread evenly;
// `around`: the points next to the shape as well, such as those of the pipes where they have left it; `before`: the
// part as it was found with another shape, from whose ends the search begins; `threshold`: as in RefineOptions, source
// units. One thread; some tens of milliseconds.
std::optional<SweptPart> swept_part(const Shape& shape, double threshold, const std::vector<Vec3d>& points,
                                    const std::vector<Vec3d>& around, const SweptPart* before = nullptr);

}  // namespace pcm
