// The height of the ground under a place, from what is in memory: for callers that must not wait, such as a walking
// eye.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace pcm {

struct GroundLimits {
    std::size_t nodes = 4096;        // visited at most
    std::uint64_t points = 200'000;  // compared at most; a chunk is compared whole or not at all
};

struct Ground {
    double height = 0;   // along the axis, source units
    double spacing = 0;  // spacing of the points that it was found from, in plan, source units
};

// Height of the sixth lowest of the 24 points in memory that are nearest to the place in plan, at any height:
// trees, wires and a few points below the surface have no effect, the lowest of several floors counts. `axis` (0 to 2)
// is the vertical one. Nothing where fewer points are in memory, and for a place that is not finite or, in plan, not
// within the bounds of the cloud. Never reads and never waits for a load. Any thread.
std::optional<Ground> ground_under(L2Cache& cache, const Vec3d& place, std::size_t axis,
                                   const GroundLimits& limits = {});

}  // namespace pcm
