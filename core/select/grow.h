// Grows a set of points by connectivity.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"

#include <cstdint>

namespace pcm {

class PlaceTest;
class SurroundingsTest;

struct GrowOptions {
    Selection limit;                                        // only points that it chooses are reached, seeds included
    const PlaceTest* test = nullptr;                        // and for which it holds (point_scan.h); may be null
    const SurroundingsTest* surroundings = nullptr;         // and which pass it (surroundings_test.h); may be null
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;  // without the set: the points looked at together
    unsigned threads = 0;                                   // 0: one per processor
    ProgressFunction progress;
};

// All points that can be reached from the seeds by steps from point to point no longer than `distance` (source units),
// through points that the limit and the tests choose. Exact: a step from p to q is one with squared_distance(p, q) <=
// distance * distance (cloud/vector.h), in double, of the source coordinates that readers of the tree get; the result
// depends neither on threads nor on memory.
//
// The cloud is divided into boxes (knn/unit_plan.h), and the flood runs in one box after another, as often as points
// that it has reached come near: what it does not come near is not read. Throws Error(invalid_argument) for a distance
// that is not positive and finite, what Selector throws, Error(cancelled), and what reading throws.
PointSet grow(const PointSet& seeds, double distance, const GrowOptions& options = {});

}  // namespace pcm
