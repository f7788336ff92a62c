#include "pcm/build/nodes/draft_index.h"

#include "pcm/tree/node_order.h"

#include <vector>

namespace pcm {
namespace {

std::uint64_t subtree_points(const Draft& draft)
{
    std::uint64_t sum = draft.points;
    for (const Draft* child : draft.children)
        if (child) sum += subtree_points(*child);
    return sum;
}

}  // namespace

TreeIndex index_of_drafts(const Draft* root)
{
    TreeIndex index;
    if (!root || subtree_points(*root) == 0) return index;
    const Draft* const none = nullptr;
    const auto order = order_nodes<const Draft*>(root, none, [&](const Draft* draft, unsigned side) {
        const Draft* const child = draft->children[side];
        return child && subtree_points(*child) > 0 ? child : none;
    });
    index.nodes = linked_nodes(order);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Draft& draft = *order[i].item;
        Node& node = index.nodes[i];
        node.points = draft.points;
        node.first_level = draft.first_level;
        node.level_points = draft.level_points;
        node.extent = draft.extent;
        node.spacing = node.is_leaf() ? 0 : draft.spacing;
        if (draft.points) node.box = draft.box;
    }
    for (std::size_t i = index.nodes.size(); i-- > 0;) {
        Node& node = index.nodes[i];
        node.subtree_points += node.points;
        if (i == 0) break;
        index.nodes[node.parent].subtree_points += node.subtree_points;
        index.nodes[node.parent].box.extend(node.box);
    }
    return index;
}

}  // namespace pcm
