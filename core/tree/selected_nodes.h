// Which nodes of a tree a selection touches.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

struct SelectedNode {
    NodeId node = no_node;
    std::uint32_t points = 0;                     // the first ones of its chunk: those of the level asked for
    BoxRelation relation = BoxRelation::crosses;  // of the node's box to box, region and conditions on coordinates
};

// The box of grid positions, where `single_precision` rounded to floats as positions are that come out as such.
Box3d source_box(const Grid& grid, const Box3i& box, bool single_precision);

// The grid positions of a tree whose source coordinates lie in a box: no others do.
Box3i grid_box(const Tree& tree, const Box3d& box);

// Nodes with points of the cloud at `level` (the whole cloud when absent) where selected ones can be, parents first.
// Every selected point is in one of them. What lies below an untouched or inside of an all selected node is not
// compared again.
std::vector<SelectedNode> selected_nodes(const Tree& tree, const Selector& selector,
                                         const std::optional<std::uint16_t>& level, bool single_precision = false);

}  // namespace pcm
