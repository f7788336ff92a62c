#include "pcm/update/extremes.h"

#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace pcm {
namespace {

// Finds the smallest point, in lexicographic order, with the coordinate `value` on an axis. Visits nodes in the order
// of the smallest point that they can hold.
void find_smallest(const Tree& tree, const std::set<NodeId>& changed, std::size_t axis, std::int64_t value, Vec3i& best,
                   bool found)
{
    using Open = std::pair<Vec3i, NodeId>;
    std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
    const auto push = [&](NodeId id) {
        const Box3i& box = tree.node(id).box;
        if (value < box.min[axis] || value > box.max[axis]) return;
        Vec3i bound = box.min;
        bound[axis] = value;
        open.push({bound, id});
    };
    if (!tree.nodes().empty()) push(0);
    while (!open.empty() && (!found || open.top().first < best)) {
        const NodeId id = open.top().second;
        open.pop();
        const Node& node = tree.node(id);
        for (const NodeId child : node.children)
            if (child != no_node) push(child);
        if (node.points == 0 || changed.count(id)) continue;
        const Chunk chunk = tree.read_chunk(id, ColumnSet::only_positions());
        for (std::size_t i = 0; i < chunk.points; ++i) {
            if (chunk.positions->grid(i, axis) != value) continue;
            const Vec3i p = chunk.positions->grid(i);
            if (!found || p < best) {
                best = p;
                found = true;
            }
        }
    }
}

}  // namespace

std::array<Vec3i, 6> find_extremes(const Tree& tree, const std::set<NodeId>& changed, const Observed& kept,
                                   const Box3i& box)
{
    std::array<Vec3i, 6> extremes{};
    for (std::size_t k = 0; k < 6; ++k) {
        const std::size_t axis = k / 2;
        const std::int64_t value = k % 2 ? box.max[axis] : box.min[axis];
        extremes[k] = kept.extremes[k];
        const bool found = kept.points > 0 && kept.extremes[k][axis] == value;
        find_smallest(tree, changed, axis, value, extremes[k], found);
    }
    return extremes;
}

}  // namespace pcm
