// The pass over all neighbourhoods that computes attributes and writes them through a cache.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cache/l2_cache.h"
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/filter/orientation_propagation.h"
#include "pcm/knn/neighbourhoods.h"

#include <cstdint>
#include <optional>

namespace pcm {

// Places in the tree's schema.
struct AttributePlaces {
    std::optional<std::size_t> radius, normal, curvature, confidence, mean_distance;  // to write
    std::optional<std::size_t> known_normal;                                          // to measure radii across
};

// The normal that an attribute gives a point, in double, of unit length; 0 where it has none or no finite one.
Vec3d known_normal_of(const Column& column, const Attribute& attribute, std::size_t point);

// The largest radius that a point may have (NeighbourAttributeOptions::radius_limit), source units.
double most_radius(const Chunk& chunk, std::size_t point, const Grid& grid, double limit);

// Computes the attributes of all points into edits of the cache; nothing is flushed. Adds to the
// report's counts. Where normals are to be consistent, they are given to `propagation`, which is null otherwise.
// Progress goes from 0 to `end`. Throws what
// for_each_neighbourhood() throws.
NeighbourhoodReport run_attribute_pass(L2Cache& cache, const NeighbourAttributeOptions& options,
                                       const AttributePlaces& places, OrientationPropagation* propagation, double end,
                                       NeighbourAttributeReport& report);

}  // namespace pcm
