// The distance from a place to the nearest point of a tree, bounded from what is in memory: for callers that must not
// wait, such as a moving camera.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace pcm {

struct ClearanceLimits {
    std::size_t nodes = 4096;        // visited at most
    std::uint64_t points = 200'000;  // compared at most; a chunk is compared whole or not at all
};

// Source units; least <= (distance to the nearest point) <= distance. The two are equal, up to rounding, when all
// chunks that can hold the nearest point are in memory.
struct Clearance {
    // Infinite for a tree without points, or a place that is not finite.
    double distance = std::numeric_limits<double>::infinity();
    double least = 0;
    double error() const { return distance - least; }
};

// Descends from the root towards `place`, nearest boxes first, and compares the points of the chunks in the cache.
// Other chunks are bounded by their boxes: boxes are tight, so each face has a point on it, and the nearest point is no
// farther than the farthest corner of the nearest face (MINMAXDIST: Roussopoulos, Kelley, Vincent, Nearest neighbor
// queries, SIGMOD 1995). Never reads and never waits for a load. Any thread.
Clearance clearance(L2Cache& cache, const Vec3d& place, const ClearanceLimits& limits = {});

}  // namespace pcm
