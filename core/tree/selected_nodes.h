// The nodes of a tree that a selection touches.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/tree/source_rounding.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

struct SelectedNode {
    NodeId node = no_node;
    std::uint32_t points = 0;                     // from the first of its chunk: those of the cloud at the given level
    BoxRelation relation = BoxRelation::crosses;  // node's box to the query's box, region and conditions
};

// The box in source coordinates, its corners rounded as positions are.
Box3d source_box(const Grid& grid, const Box3i& box, const SourceRounding& rounding);

// The box of exactly those grid positions within the tree's box whose source coordinates lie in `box`.
Box3i grid_box(const Tree& tree, const Box3d& box);

// The nodes that can have selected points of the cloud at `level` (of the whole cloud when absent), parents first.
// Every selected point is in one of them. The box of a node is compared with the selection only if its parent's box
// crosses the selection's border.
std::vector<SelectedNode> selected_nodes(const Tree& tree, const Selector& selector,
                                         const std::optional<std::uint16_t>& level);

}  // namespace pcm
