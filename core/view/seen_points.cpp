#include "pcm/view/seen_points.h"

#include <algorithm>
#include <optional>

namespace pcm {
namespace {

constexpr int steps = 4;  // steps through a box along each axis

double share_in_view(const Frustum& frustum, const std::vector<Clip>* clips, const Box3d& box)
{
    if (!frustum.intersects(box)) return 0;
    const BoxRelation clipped = clips ? relation_of(*clips, box) : BoxRelation::inside;
    if (clipped == BoxRelation::outside) return 0;
    if (clipped == BoxRelation::inside && frustum.contains(box)) return 1;
    int seen = 0;
    for (int i = 0; i < steps * steps * steps; ++i) {
        const int along[3] = {i % steps, i / steps % steps, i / (steps * steps)};
        Vec3d p{};
        for (std::size_t a = 0; a < 3; ++a) p[a] = box.min[a] + (along[a] + 0.5) / steps * (box.max[a] - box.min[a]);
        if (!frustum.intersects({p, p})) continue;
        seen += !clips || std::all_of(clips->begin(), clips->end(), [&](const Clip& clip) { return clip.holds(p); });
    }
    return static_cast<double>(seen) / (steps * steps * steps);
}

}  // namespace

double seen_points(const std::vector<TreeInView>& trees, const SceneSelection& selection, double enough)
{
    std::vector<std::optional<Frustum>> frusta;
    for (const TreeInView& tree : trees) frusta.push_back(Frustum::of(tree.view));
    double seen = 0;
    for (const SceneSelection::Place& place : selection.order) {
        if (seen >= enough) break;
        const TreeInView& tree = trees[place.tree];
        const Node& node = (*tree.nodes)[selection.trees[place.tree].wanted[place.index].node];
        seen += static_cast<double>(node.points) *
                share_in_view(*frusta[place.tree], tree.clips, tree.grid->to_source(node.box));
    }
    return seen;
}

SceneSelection select_scene_seen(const std::vector<TreeInView>& trees, DetailLimits& limits, double least_seen,
                                 std::uint64_t most_points)
{
    SceneSelection selection = select_scene(trees, limits);
    while (selection.budget_reached && limits.point_budget < most_points &&
           seen_points(trees, selection, least_seen) < least_seen) {
        const std::size_t before = selection.order.size();
        limits.point_budget = std::min(most_points, 2 * std::max<std::uint64_t>(1, limits.point_budget));
        selection = select_scene(trees, limits);
        // Video memory may be what ends it.
        if (limits.point_budget == most_points && selection.order.size() == before) break;
    }
    return selection;
}

}  // namespace pcm
