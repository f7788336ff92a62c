// How long a pass over neighbourhoods is going to take, from a short run of it.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/filter/attribute_pass.h"
#include "pcm/filter/neighbour_attributes.h"

#include <cstddef>

namespace pcm {

struct PredictedTime {
    double prepare = 0;  // seconds per point of the cloud: reading, sorting into units; all threads together
    double compute = 0;  // seconds per computed point; all threads together
    double write = 0;    // seconds per point of the cloud
    // Seconds for the whole filter when the points of levels 0..level are computed.
    double of_level(const Tree& tree, std::size_t level) const;
};

// Searches neighbourhoods as the filter is going to for about `seconds`, at least a hundredth and at most one, and
// encodes the largest chunk. Nothing is changed. Throws what for_each_neighbourhood() throws.
PredictedTime predict_time(L2Cache& cache, const NeighbourAttributeOptions& options, const AttributePlaces& places,
                           double seconds);

}  // namespace pcm
