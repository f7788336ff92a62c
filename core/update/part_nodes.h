// The nodes of a tree by themselves, as an update changes them, and how they become a node vector again.
#pragma once

#include "pcm/bpc/chunk_identity.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <vector>

namespace pcm {

struct PartNode {
    NodeId id = no_node;  // in the tree that it is of, where it is of one
    std::uint32_t part = 0;
    NodePath path;  // within the part
    std::uint32_t points = 0;
    std::uint16_t first_level = 0;
    std::vector<std::uint32_t> level_points;
    double spacing = 0;  // as Node.spacing would be, were it no leaf
    Box3i box;           // of its own points; or of its subtree's, where nothing below it changes
    Extent extent;
};

// The nodes of a tree, in the order of its node vector without those that join parts.
std::vector<PartNode> part_nodes(const Tree& tree);

struct NodeVector {
    std::vector<Node> nodes;
    std::vector<NodeId>
        part_roots;  // by the parts' numbers, up to the last that has points; no_node for one that has none
};

// The node vector that these nodes make: breadth first, so parents first. Nodes below which there are no points vanish,
// nodes between others come to be where they are missing; such a one has the spacing of the node above. Parts are
// joined by nodes without points, balanced, each half of the parts on one side of a plane as far as their boxes allow.
// The order of `nodes` does not matter, and each (part, path) is there once. `spacings` are the tree's levels'.
NodeVector join_parts(const std::vector<PartNode>& nodes, const std::vector<double>& spacings, const Vec3d& scale);

}  // namespace pcm
