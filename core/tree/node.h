// A node of a tree.
#pragma once

#include "pcm/cloud/geometry.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

using NodeId = std::uint32_t;
inline constexpr NodeId no_node = 0xffffffffu;
inline constexpr std::uint32_t no_part = 0xffffffffu;

// Where a chunk lies: `bytes` bytes at `offset` of data file number `file`. bytes == 0 for a node without points.
struct Extent {
    std::uint32_t file = 0;
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;
    std::uint32_t header_bytes = 0;  // how many of them are the chunk's header
    bool operator==(const Extent& o) const
    {
        return file == o.file && offset == o.offset && bytes == o.bytes && header_bytes == o.header_bytes;
    }
};

struct Node {
    NodeId parent = no_node;
    std::array<NodeId, 2> children{no_node, no_node};
    std::uint16_t depth = 0;        // 0 at the root
    std::uint32_t part = 0;         // no_part for a node that joins parts
    std::uint16_t first_level = 0;  // first level of its own points
    std::uint32_t points = 0;       // number of points of this node's own chunk
    // Number of points of first_level, of the next level, ..., in the order of the chunk; empty for a node without
    // points.
    std::vector<std::uint32_t> level_points;
    std::uint64_t subtree_points = 0;  // number of points of this node and everything below
    Box3i box;                         // tight around the points of the whole subtree
    double spacing = 0;                // source units: distance between the points of the subtree's box once this node
                                       // and its ancestors are drawn; 0 at a leaf but where a repair found none below
    Extent extent;
    bool is_leaf() const { return children[0] == no_node && children[1] == no_node; }
    // Number of points, from the first of the chunk, that belong to the cloud at `level`.
    std::uint32_t points_to_level(std::size_t level) const
    {
        std::uint32_t sum = 0;
        for (std::size_t k = 0; k < level_points.size() && first_level + k <= level; ++k) sum += level_points[k];
        return sum;
    }
};

}  // namespace pcm
