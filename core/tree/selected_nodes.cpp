#include "tree/selected_nodes.h"

namespace pcm {

Box3d source_box(const Grid& grid, const Box3i& box, bool single_precision)
{
    Box3d source = grid.to_source(box);
    if (single_precision)
        for (std::size_t a = 0; a < 3; ++a) {
            source.min[a] = static_cast<double>(static_cast<float>(source.min[a]));
            source.max[a] = static_cast<double>(static_cast<float>(source.max[a]));
        }
    return source;
}

std::vector<SelectedNode> selected_nodes(const Tree& tree, const Selector& selector, const std::optional<std::uint16_t>& level,
                                         bool single_precision)
{
    const std::vector<Node>& nodes = tree.nodes();
    std::vector<BoxRelation> relations(nodes.size(), BoxRelation::outside);
    std::vector<SelectedNode> result;
    for (NodeId id = 0; id < nodes.size(); ++id) {
        const Node& node = nodes[id];
        const BoxRelation above = node.parent == no_node ? BoxRelation::crosses : relations[node.parent];
        if (above == BoxRelation::outside) continue;
        // Finer levels are below: a node that begins beyond the level ends the way down.
        if (level && node.points > 0 && node.first_level > *level) continue;
        relations[id] = above == BoxRelation::inside ? above
                                                     : selector.relation(source_box(tree.info().grid, node.box, single_precision));
        const std::uint32_t points = level ? node.points_to_level(*level) : node.points;
        if (relations[id] != BoxRelation::outside && points > 0) result.push_back({id, points, relations[id]});
    }
    return result;
}

}  // namespace pcm
