// The corners of a box by number.
#pragma once

#include "pcm/cloud/geometry.h"

namespace pcm::shapes {

// Corner c of a box has the largest coordinate along axis a where bit a of c is set.
inline Vec3d corner_of(const Box3d& box, unsigned c)
{
    return {c & 1 ? box.max[0] : box.min[0], c & 2 ? box.max[1] : box.min[1], c & 4 ? box.max[2] : box.min[2]};
}

}  // namespace pcm::shapes
