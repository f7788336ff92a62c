// Grows a set of points from one point, through points that resemble it.
#pragma once

#include "pcm/select/grow.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace pcm {

// Each limit compares a point with the seed, not with the point that the step comes from: a step after step comparison
// follows noise and soft edges to everywhere. What is absent is not compared.
struct SeedLimits {
    // Maximum angle between the normals as lines (the sign of a normal has no effect), radians, 0 to pi / 2. Points
    // without a normal (all zero, or not finite) are not reached.
    std::optional<double> normal_angle;
    // Maximum distance between the colours: red, green and blue as 0 to 255 each (view/point_colours.h), so that black
    // and white are 441.7 apart.
    std::optional<double> colour_difference;
    // Maximum distance from the seed, source units, inclusive as Region::sphere() is.
    std::optional<double> within;

    bool reads_attributes() const { return normal_angle || colour_difference; }
};

// All points that steps no longer than `distance` reach from the point `number` of `node` (grow.h), through points that
// options.limit, options.test and the limits choose. Empty where the point itself is not chosen. Throws what grow()
// throws; Error(invalid_argument) for limits out of range, a limit on normals or colours where the cloud has none, or
// where the seed has no normal, and for a point that the tree does not have.
PointSet grow_from(const std::shared_ptr<const Tree>& tree, NodeId node, std::uint32_t number, double distance,
                   const SeedLimits& limits, const GrowOptions& options = {});

// What a user should know of a set that was grown: that it is nearly all of the cloud (95 % and more), and which limits
// help. Empty: nothing.
std::string note_on_growth(const PointSet& grown);

}  // namespace pcm
