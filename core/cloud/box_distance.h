// How far a point is from a box.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/vector.h"

#include <algorithm>

namespace pcm {

// Square of the distance of `p` from the nearest point of a box that is not empty; 0 inside. No point of the box has a
// smaller squared_distance(), rounding included.
inline double squared_distance(const Box3d& box, const Vec3d& p)
{
    return squared_distance(Vec3d{std::clamp(p[0], box.min[0], box.max[0]), std::clamp(p[1], box.min[1], box.max[1]),
                                  std::clamp(p[2], box.min[2], box.max[2])},
                            p);
}

}  // namespace pcm
