// How far a place is from the nearest points of a tree, as far as memory knows: for those who must not wait, as a
// moving camera.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace pcm {

struct ClearanceLimits {
    std::size_t nodes = 4096;        // looked at, most
    std::uint64_t points = 200'000;  // compared, most; a chunk is compared whole or not at all
};

// Source units; least <= (distance to the nearest point) <= distance. The two are equal where the chunks that matter
// are in memory.
struct Clearance {
    double distance =
        std::numeric_limits<double>::infinity();  // infinite for a tree without points, or a place that is not finite
    double least = 0;
    double error() const { return distance - least; }
};

// Descends from the root towards `place`, nearest boxes first, and compares the points of the chunks that the cache
// has. Of the others it knows their boxes: boxes are tight, so each face has a point on it, and the nearest point is no
// farther than the nearest face's farthest corner (MINMAXDIST: Roussopoulos, Kelley, Vincent, Nearest neighbor queries,
// SIGMOD 1995). Never reads and never waits for a load. Any thread.
Clearance clearance(L2Cache& cache, const Vec3d& place, const ClearanceLimits& limits = {});

}  // namespace pcm
