// The pass over all neighbourhoods that computes attributes.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cache/l2_cache.h"
#include "pcm/filter/attribute_places.h"
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/filter/orientation_propagation.h"
#include "pcm/knn/neighbourhoods.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace pcm {

// The normal that an attribute gives a point, in double, of unit length; 0 where it has none or no finite one.
Vec3d known_normal_of(const Column& column, const Attribute& attribute, std::size_t point);

// The largest radius that a point may have (NeighbourAttributeOptions::radius_limit), source units.
double most_radius(const Chunk& chunk, std::size_t point, const Grid& grid, double limit);

// How many points of a unit, or of a cloud, have values of less worth: NeighbourAttributeReport.
struct AttributeCounts {
    std::uint64_t lines = 0, blobs = 0, too_few = 0, two_surfaces = 0, flipped = 0, limited = 0;
    void add_to(NeighbourAttributeReport& report) const;
};

// The values of a unit's points, keyed by number in the unit; empty where none are computed.
struct UnitAttributes {
    std::vector<float> radius, curvature, mean_distance;
    std::vector<std::array<float, 3>> normal;
    std::vector<std::uint8_t> confidence;
    UnitOrientation orientation;  // where normals are to be consistent
    AttributeCounts counts;
};

// Takes the values of units. Any number of threads may call.
class UnitSink {
public:
    virtual ~UnitSink() = default;
    virtual void take(const NeighbourhoodUnit& unit, const UnitAttributes& values) = 0;
    virtual void skip(std::size_t /*unit*/) {}  // a unit without points
};

// Computes the attributes of the units of NeighbourhoodOptions::next_unit, all where it is empty. The cache is only
// read. Progress goes from 0 to `end`. Throws what for_each_neighbourhood() and the sink throw.
NeighbourhoodReport run_attribute_pass(L2Cache& cache, const NeighbourAttributeOptions& options,
                                       const AttributePlaces& places, UnitSink& sink, double end,
                                       const std::function<std::size_t()>& next_unit = {});

}  // namespace pcm
