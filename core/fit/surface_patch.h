// A shape as least squares moves it.
//
// A patch is the shape described at a place on its surface near the points, by curvatures instead
// of radii (after Lukacs, Martin, Marshall 1998). A sphere of a thousand times the points' extent, a plane almost, is
// then as well scaled as a ball. Moves are rotations about that place, translations along its frame, and changes of
// curvature. With e = p - place, a pure curvature k = 1 / radius along n gives
//     q = 2 n.e + k e.e,  w = sqrt(1 + k q) = |n + k e|,  distance = q / (1 + w),  gradient (n + k e) / w
// (for a cylinder of e across the axis), which is exact for k = 0, a plane, and below 0 too: the normal points inwards.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/fit/block_loops.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace pcm {

struct SurfacePatch {
    Vec3d place{};                             // on the surface
    Vec3d a{0, 0, 1}, n{1, 0, 0}, b{0, 1, 0};  // right-handed; `a` along the axis, n across it
    double along = 0, out = 1;                 // the normal at `place` is out n + along a
    double curvature = 0, second = 0;          // see the models
    Vec3d normal() const { return out * n + along * a; }
};

// Sums over the points near a patch.
struct PatchSums {
    std::size_t parameters = 0;
    double used = 0;  // sum of weights
    std::uint64_t inliers = 0;
    double squares = 0;  // sum of their squared distances, weighted
    double pull = 0;     // sum of squares of weight times distance
    double slope = 0;    // sum of the growth of weight times distance with the distance
    double cost = 0;     // sum over all points of the lesser of square and squared threshold
    std::array<double, most_parameters> gradient{};
    std::array<double, most_parameters * most_parameters> products{};  // the upper half
};

}  // namespace pcm
