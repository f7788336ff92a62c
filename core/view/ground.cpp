#include "pcm/view/ground.h"

#include "pcm/cloud/numbers.h"
#include "pcm/cloud/vector.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace pcm {
namespace {

constexpr std::size_t asked = 24, lowest = 6;

// The nearest points in plan: squared distance and height.
class NearestInPlan {
public:
    NearestInPlan(const Grid& grid, const Vec3d& place, std::size_t axis) : grid_(grid), place_(place), up_(axis)
    {
        flat_[0] = (axis + 1) % 3;
        flat_[1] = (axis + 2) % 3;
    }

    double distance(const Box3d& box) const
    {
        double sum = 0;
        for (const std::size_t a : flat_)
            sum += square(std::max({box.min[a] - place_[a], place_[a] - box.max[a], 0.0}));
        return sum;
    }
    // Infinite until there are enough points.
    double farthest() const { return found_.size() < asked ? HUGE_VAL : found_.front().first; }

    void compare(const ChunkPositions& positions)
    {
        Vec3d to_place;
        for (std::size_t a = 0; a < 3; ++a) to_place[a] = place_[a] - grid_.to_source(positions.origin[a], a);
        if (positions.wide)
            compare(positions.wide_xyz, to_place);
        else
            compare(positions.narrow_xyz, to_place);
    }

    std::optional<Ground> ground()
    {
        if (found_.size() < asked) return std::nullopt;
        const double area = pi * found_.front().first / static_cast<double>(asked);
        std::vector<double> heights;
        for (const auto& [apart, height] : found_) heights.push_back(height);
        std::nth_element(heights.begin(), heights.begin() + (lowest - 1), heights.end());
        return Ground{heights[lowest - 1], std::sqrt(area)};
    }

private:
    // Differences on the grid keep their precision at map coordinates.
    template <class Integer>
    void compare(const std::array<PageVector<Integer>, 3>& positions, const Vec3d& to_place)
    {
        const std::size_t u = flat_[0], v = flat_[1];
        for (std::size_t i = 0; i < positions[0].size(); ++i) {
            const double apart = square(static_cast<double>(positions[u][i]) * grid_.scale[u] - to_place[u]) +
                                 square(static_cast<double>(positions[v][i]) * grid_.scale[v] - to_place[v]);
            if (!(apart < farthest())) continue;
            if (found_.size() == asked) {
                std::pop_heap(found_.begin(), found_.end());
                found_.pop_back();
            }
            const double over = static_cast<double>(positions[up_][i]) * grid_.scale[up_] - to_place[up_];
            found_.emplace_back(apart, place_[up_] + over);
            std::push_heap(found_.begin(), found_.end());
        }
    }

    const Grid& grid_;
    const Vec3d place_;
    const std::size_t up_;
    std::array<std::size_t, 2> flat_{};
    std::vector<std::pair<double, double>> found_;  // a heap, the farthest first
};

}  // namespace

std::optional<Ground> ground_under(L2Cache& cache, const Vec3d& place, std::size_t axis, const GroundLimits& limits)
{
    const Tree& tree = cache.tree();
    if (axis > 2 || tree.nodes().empty() || tree.info().points == 0 || !is_finite(place)) return std::nullopt;
    NearestInPlan near(tree.info().grid, place, axis);
    if (near.distance(tree.info().bounds()) > 0) return std::nullopt;
    using Open = std::pair<double, NodeId>;  // squared distance to its box in plan
    std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
    const auto ask = [&](NodeId id) {
        const Node* const node = tree.nodes().find(id);  // null: its points are not in memory either
        if (node && node->subtree_points > 0) open.emplace(near.distance(tree.box(id)), id);
    };
    ask(0);
    std::uint64_t compared = 0;
    for (std::size_t seen = 0; !open.empty() && open.top().first < near.farthest() && seen < limits.nodes; ++seen) {
        const NodeId id = open.top().second;
        open.pop();
        const Node& node = tree.node(id);
        if (node.points > 0 && compared + node.points <= limits.points)
            if (const L2Cache::Handle chunk = cache.find(id, ColumnSet::only_positions())) {
                compared += node.points;
                near.compare(*chunk->positions);
            }
        for (const NodeId child : node.children)
            if (child != no_node) ask(child);
    }
    return near.ground();
}

}  // namespace pcm
