// The distance from a point to a box.
#pragma once

#include "pcm/cloud/geometry.h"

#include <algorithm>

namespace pcm {

// Square of the distance from `p` to the nearest point of a box, which is not empty; 0 inside. No point of the box has
// a smaller squared_distance() from `p`, rounding included.
inline double squared_distance(const Box3d& box, const Vec3d& p)
{
    return squared_distance(Vec3d{std::clamp(p[0], box.min[0], box.max[0]), std::clamp(p[1], box.min[1], box.max[1]),
                                  std::clamp(p[2], box.min[2], box.max[2])},
                            p);
}

}  // namespace pcm
