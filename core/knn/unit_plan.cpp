#include "pcm/knn/unit_plan.h"

#include "pcm/knn/grid_steps.h"

#include <algorithm>

namespace pcm {
namespace {

std::int64_t middle(std::int64_t low, std::int64_t high)
{
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + grid_steps(low, high) / 2);
}

bool holds(const Box3i& outer, const Box3i& inner) { return outer.contains(inner.min) && outer.contains(inner.max); }

Box3i common(const Box3i& a, const Box3i& b)
{
    Box3i both;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        both.min[axis] = std::max(a.min[axis], b.min[axis]);
        both.max[axis] = std::min(a.max[axis], b.max[axis]);
    }
    return both;
}

// Points of a subtree in a box; those of a chunk count as spread evenly over the node's box.
double count(const Tree& tree, NodeId id, const Box3i& box)
{
    const Node& node = tree.node(id);
    if (node.box.empty()) return 0;
    if (holds(box, node.box)) return double(node.subtree_points);
    const Box3i shared = common(node.box, box);
    if (shared.empty()) return 0;
    double share = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
        share *= (double(grid_steps(shared.min[axis], shared.max[axis])) + 1) /
                 (double(grid_steps(node.box.min[axis], node.box.max[axis])) + 1);
    double sum = share * node.points;
    for (const NodeId child : node.children)
        if (child != no_node) sum += count(tree, child, box);
    return sum;
}

class Planner {
public:
    Planner(const Tree& tree, std::uint64_t points_per_unit) : tree_(tree), most_(double(points_per_unit)) {}

    std::vector<Box3i> plan()
    {
        if (!tree_.nodes().empty() && tree_.info().points > 0) divide(tree_.info().box, {0});
        return std::move(units_);
    }

private:
    // `nodes`: roots of subtrees that hold all points of the region.
    void divide(const Box3i& region, const std::vector<NodeId>& nodes)
    {
        std::vector<NodeId> inside;
        Box3i tight;
        for (const NodeId node : nodes) add(node, region, inside, tight);
        if (tight.empty()) return;
        const double points = count(inside, tight);
        const std::size_t axis = longest(tight);
        if (points <= most_ || tight.min[axis] == tight.max[axis]) {
            units_.push_back(tight);
            return;
        }
        Box3i low = tight, high = tight;
        low.max[axis] = cut(inside, tight, axis, points / 2);
        high.min[axis] = low.max[axis] + 1;
        divide(low, inside);
        divide(high, inside);
    }

    void add(NodeId id, const Box3i& region, std::vector<NodeId>& inside, Box3i& tight) const
    {
        const Node& node = tree_.node(id);
        const Box3i shared = common(node.box, region);
        if (node.box.empty() || shared.empty()) return;
        inside.push_back(id);
        tight.extend(shared);
    }

    std::size_t longest(const Box3i& box) const
    {
        std::size_t best = 0;
        double length = -1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double here = double(grid_steps(box.min[axis], box.max[axis])) * tree_.info().grid.scale[axis];
            if (here > length) {
                length = here;
                best = axis;
            }
        }
        return best;
    }

    // The last coordinate of the lower half: at least `half` of the points lie up to there, as far as is known.
    std::int64_t cut(const std::vector<NodeId>& nodes, const Box3i& box, std::size_t axis, double half) const
    {
        std::int64_t low = box.min[axis], high = box.max[axis] - 1;
        while (low < high) {
            const std::int64_t at = middle(low, high);
            Box3i part = box;
            part.max[axis] = at;
            if (count(nodes, part) < half)
                low = at + 1;
            else
                high = at;
        }
        return low;
    }

    double count(const std::vector<NodeId>& nodes, const Box3i& box) const
    {
        double sum = 0;
        for (const NodeId node : nodes) sum += pcm::count(tree_, node, box);
        return sum;
    }

    const Tree& tree_;
    const double most_;
    std::vector<Box3i> units_;
};

}  // namespace

std::vector<Box3i> plan_units(const Tree& tree, std::uint64_t points_per_unit)
{
    return Planner(tree, points_per_unit).plan();
}

double estimated_points(const Tree& tree, const Box3i& box) { return tree.nodes().empty() ? 0 : count(tree, 0, box); }

}  // namespace pcm
