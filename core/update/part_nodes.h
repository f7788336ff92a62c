// The nodes of a tree as a list without links, which an update changes, and its conversion to a node vector.
#pragma once

#include "pcm/bpc/chunk_identity.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <vector>

namespace pcm {

struct PartNode {
    NodeId id = no_node;  // in its tree; no_node for a node that is in no tree yet
    std::uint32_t part = 0;
    NodePath path;  // within the part
    std::uint32_t points = 0;
    std::uint16_t first_level = 0;
    std::vector<std::uint32_t> level_points;
    double spacing = 0;  // Node::spacing, as its chunk says
    Box3i box;           // box of its own points, or of the subtree's points where nothing below the node changes
    Extent extent;
};

// The nodes of a tree in the order of its node vector, without the nodes that join parts.
std::vector<PartNode> part_nodes(const Tree& tree);

struct NodeVector {
    std::vector<Node> nodes;
    // The root of each part up to the last one with points; no_node for a part without points.
    std::vector<NodeId> part_roots;
};

// The node vector of these nodes, in the order of node_order.h. Subtrees without points are removed. Missing inner
// nodes are added, with the spacing of the node above. The parts are joined by a balanced tree of nodes without points,
// each half of the parts on one side of a plane as far as their boxes allow. The result does not depend on the order of
// `nodes`; each (part, path) occurs once. `spacings` are those of the tree's levels.
NodeVector join_parts(const std::vector<PartNode>& nodes, const std::vector<double>& spacings, const Vec3d& scale);

}  // namespace pcm
