// The spacing of a cloud's points at a place, from several of them.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/geometry.h"

namespace pcm {

// The median over the 16 points nearest to the place of the mean distance to their 4 nearest neighbours at other
// places, source units, at full resolution: one point in a gap, or two at one place, do not decide. 0 where the cloud
// has fewer than two places. Reads the chunks around the place. Any thread. Throws what find_nearest() throws.
double local_spacing(L2Cache& cache, const Vec3d& place);

}  // namespace pcm
