// How grids lie to each other.
#pragma once

#include "pcm/cloud/geometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcm {

// Whether two grids of equal scale differ by whole steps, few enough that doubles keep their positions distinct.
inline bool steps_apart(const Grid& a, const Grid& b)
{
    if (a.scale != b.scale) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double steps = (b.offset[axis] - a.offset[axis]) / a.scale[axis];
        if (!(std::fabs(steps - std::round(steps)) <= 1e-6)) return false;
        const double largest =
            std::max(std::fabs(a.offset[axis]), std::fabs(b.offset[axis])) / std::fabs(a.scale[axis]);
        if (!(largest + 0x1p32 < 0x1p50)) return false;
    }
    return true;
}

}  // namespace pcm
