#include "pcm/view/clearance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>
#include <vector>
#include "pcm/cloud/box_distance.h"
#include "pcm/cloud/numbers.h"

namespace pcm {
namespace {

// Relative rounding error of a squared distance: subtracted from the lower bound, added to the upper one.
constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();

// MINMAXDIST squared: some point of a tight box is at most this far.
double farthest_nearest_of(const Box3d& box, const Vec3d& p)
{
    double near_face[3], far_side[3];
    for (std::size_t a = 0; a < 3; ++a) {
        const double to_min = square(p[a] - box.min[a]), to_max = square(p[a] - box.max[a]);
        near_face[a] = std::min(to_min, to_max);
        far_side[a] = std::max(to_min, to_max);
    }
    double best = infinity;
    for (std::size_t a = 0; a < 3; ++a)
        best = std::min(best, near_face[a] + far_side[(a + 1) % 3] + far_side[(a + 2) % 3]);
    return best;
}

// The squared distance to the nearest point of a chunk. Positions are integers relative to the chunk's origin, so the
// differences keep their precision at map coordinates.
template <class Integer>
double nearest_of(const std::array<PageVector<Integer>, 3>& positions, const Vec3d& origin_to_place, const Vec3d& scale)
{
    double best = infinity;
    for (std::size_t i = 0; i < positions[0].size(); ++i) {
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a)
            sum += square(static_cast<double>(positions[a][i]) * scale[a] - origin_to_place[a]);
        best = std::min(best, sum);
    }
    return best;
}

double nearest_of(const ChunkPositions& positions, const Grid& grid, const Vec3d& place)
{
    Vec3d to_place;
    for (std::size_t a = 0; a < 3; ++a) to_place[a] = place[a] - grid.to_source(positions.origin[a], a);
    return positions.wide ? nearest_of(positions.wide_xyz, to_place, grid.scale)
                          : nearest_of(positions.narrow_xyz, to_place, grid.scale);
}

}  // namespace

Clearance clearance(L2Cache& cache, const Vec3d& place, const ClearanceLimits& limits)
{
    Clearance result;
    const Tree& tree = cache.tree();
    if (tree.nodes().empty() || tree.info().points == 0) {
        result.least = infinity;
        return result;
    }
    if (!is_finite(place)) return result;

    const Grid& grid = tree.info().grid;
    // The rounding error of a coordinate, per axis.
    double coordinate_error = 0;
    const Box3d bounds = tree.info().bounds();
    for (std::size_t a = 0; a < 3; ++a)
        coordinate_error =
            std::max({coordinate_error, std::fabs(bounds.min[a]), std::fabs(bounds.max[a]), std::fabs(place[a])});
    coordinate_error *= rounding;

    using Open = std::pair<double, NodeId>;  // squared distance to its box
    std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
    double nearest = infinity;  // squared: a point is at most this far
    double unknown = infinity;  // squared: a point that was not compared may be this near
    std::uint64_t compared = 0;
    std::size_t looked_at = 0;
    // A node that has not been read is somewhere in its parent's box, at this squared distance.
    const auto ask = [&](NodeId id, double square_above) {
        const Node* const node = tree.nodes().find(id);
        if (!node) unknown = std::min(unknown, square_above);
        if (!node || node->subtree_points == 0) return;
        const Box3d box = tree.box(id);
        nearest = std::min(nearest, farthest_nearest_of(box, place));
        open.emplace(squared_distance(box, place), id);
    };
    ask(0, 0);
    while (!open.empty() && open.top().first < nearest && looked_at < limits.nodes) {
        const auto [box_square, id] = open.top();
        open.pop();
        ++looked_at;
        const Node& node = tree.node(id);
        if (node.points > 0) {
            const L2Cache::Handle chunk = compared + node.points <= limits.points
                                              ? cache.find(id, ColumnSet::only_positions())
                                              : L2Cache::Handle();
            if (chunk) {
                compared += node.points;
                nearest = std::min(nearest, nearest_of(*chunk->positions, grid, place));
            } else {
                unknown = std::min(unknown, box_square);
            }
        }
        for (const NodeId child : node.children)
            if (child != no_node) ask(child, box_square);
    }
    if (!open.empty()) unknown = std::min(unknown, open.top().first);
    const double least = std::min(nearest, unknown);
    result.distance = std::sqrt(nearest) * (1 + rounding) + 2 * coordinate_error;
    result.least = std::max(0.0, std::sqrt(least) * (1 - rounding) - 2 * coordinate_error);
    return result;
}

}  // namespace pcm
