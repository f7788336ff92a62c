#include "pcm/tree/selected_nodes.h"

namespace pcm {

Box3d source_box(const Grid& grid, const Box3i& box, const SourceRounding& rounding)
{
    return rounding(grid.to_source(box));
}

Box3i grid_box(const Tree& tree, const Box3d& box)
{
    const TreeInfo& info = tree.info();
    const SourceRounding rounding(info);
    // The first number of [low, high] for which `holds` returns true, as it does for all larger ones; high + 1 if there
    // is none.
    const auto first = [](std::int64_t low, std::int64_t high, const auto& holds) {
        auto from = static_cast<std::uint64_t>(low), count = static_cast<std::uint64_t>(high) - from + 1;
        while (count > 0) {
            const std::uint64_t half = count / 2;
            if (holds(static_cast<std::int64_t>(from + half))) {
                count = half;
            } else {
                from += half + 1;
                count -= half + 1;
            }
        }
        return static_cast<std::int64_t>(from);
    };
    Box3i result;
    if (box.empty() || info.box.empty()) return result;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t low = info.box.min[a], high = info.box.max[a];
        result.min[a] =
            first(low, high, [&](std::int64_t q) { return rounding(info.grid.to_source(q, a), a) >= box.min[a]; });
        result.max[a] =
            first(low, high, [&](std::int64_t q) { return rounding(info.grid.to_source(q, a), a) > box.max[a]; }) - 1;
    }
    return result;
}

std::vector<SelectedNode> selected_nodes(const Tree& tree, const Selector& selector,
                                         const std::optional<std::uint16_t>& level)
{
    const SourceRounding rounding(tree.info());
    const NodeTable& nodes = tree.nodes();
    std::vector<BoxRelation> relations(nodes.size(), BoxRelation::outside);
    std::vector<SelectedNode> result;
    for (NodeId id = 0; id < nodes.size(); ++id) {
        const Node& node = nodes[id];
        const BoxRelation above = node.parent == no_node ? BoxRelation::crosses : relations[node.parent];
        if (above == BoxRelation::outside) continue;
        // The nodes below hold finer levels only.
        if (level && node.points > 0 && node.first_level > *level) continue;
        relations[id] =
            above == BoxRelation::inside ? above : selector.relation(source_box(tree.info().grid, node.box, rounding));
        const std::uint32_t points = level ? node.points_to_level(*level) : node.points;
        if (relations[id] != BoxRelation::outside && points > 0) result.push_back({id, points, relations[id]});
    }
    return result;
}

}  // namespace pcm
