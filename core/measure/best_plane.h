// The plane of least squares through points.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <vector>

namespace pcm {

// The plane through points that are given relative to a place near them.
struct BestPlane {
    Vec3d centre{};                  // the points' mean, relative to the same place
    std::array<Vec3d, 3> axes{};     // unit, perpendicular: axes of maximum, middle and minimum extent; axes[2] is
                                     // the normal
    std::array<double, 3> extent{};  // root of the sum of the squares of (p - centre) . axes[k]; descending
};

// By Hestenes' one-sided Jacobi rotations of the points themselves: small extents keep their digits if others are
// large. Three or more points, finite.
BestPlane best_plane(const std::vector<Vec3d>& points);

}  // namespace pcm
