// All that a cloud knows about one of its points, as text with all digits.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/view/point_sizes.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

struct DescribedAttribute {
    std::string name;
    // One per component, in the attribute's own unit (raw * scale + offset): integers and steps of a decimal scale
    // exactly, others with the fewest digits that read back as the same number.
    std::vector<std::string> values;
    std::string text() const;  // separated by blanks
};

struct PointDescription {
    Vec3d position{};  // as the source has it (tree/source_rounding.h)
    // The same as text: the decimal number that steps of the grid stand for (848935.2), where the nearest double has
    // more digits (848935.2000000001); else the fewest digits that read back as the same number.
    std::array<std::string, 3> position_text;
    std::uint16_t level = 0;
    double spacing = 0;    // about the distance to its neighbours, or the radius that its cloud gives it; source units
    double grid_step = 0;  // the largest step of the grid that positions are on, source units
    std::vector<DescribedAttribute> attributes;  // all, in the schema's order
};

// Reads the segment with the point past the cache, unless the cache has the chunk. Any number of threads. Throws
// Error(invalid_argument) for a point that the tree does not have, and what reading throws.
PointDescription describe_point(L2Cache& cache, const PointSizes& sizes, NodeId node, std::uint32_t index);

}  // namespace pcm
