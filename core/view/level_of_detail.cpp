#include "pcm/view/level_of_detail.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

namespace pcm {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

SceneSelection select_scene(const std::vector<TreeInView>& trees, const DetailLimits& limits)
{
    struct Candidate {
        double rank;
        std::uint32_t tree;
        DetailNode node;
    };
    const auto after = [](const Candidate& a, const Candidate& b) {
        if (a.rank != b.rank) return a.rank < b.rank;
        return a.tree != b.tree ? a.tree > b.tree : a.node.node > b.node.node;
    };
    std::priority_queue<Candidate, std::vector<Candidate>, decltype(after)> queue(after);
    std::vector<std::optional<Frustum>> frusta(trees.size());
    // A node without points is never drawn: it is kept for what is below it.
    const auto gain = [&](std::uint32_t tree, NodeId node) {
        return limits.kept && ((*trees[tree].nodes)[node].points == 0 || limits.kept(tree, node))
                   ? DetailLimits::kept_gain
                   : 1.0;
    };
    const auto consider = [&](std::uint32_t tree, NodeId id, std::uint32_t ancestor) {
        const std::vector<Node>& nodes = *trees[tree].nodes;
        const Node& node = nodes[id];
        if (node.subtree_points == 0) return;
        const Box3d box = trees[tree].grid->to_source(node.box);
        if (!frusta[tree]->intersects(box)) return;
        const double error = ancestor == no_ancestor ? infinity : frusta[tree]->pixels(nodes[node.parent].spacing, box);
        const double rank =
            limits.order == DetailOrder::error ? error * gain(tree, id) : -static_cast<double>(node.depth);
        queue.push({rank, tree, {id, ancestor, error}});
    };

    SceneSelection scene;
    scene.trees.resize(trees.size());
    for (std::uint32_t t = 0; t < trees.size(); ++t) {
        frusta[t] = Frustum::of(trees[t].view);
        if (!frusta[t] || trees[t].nodes->empty()) continue;
        scene.trees[t].viewport_px = std::max(trees[t].view.width, trees[t].view.height);
        consider(t, 0, no_ancestor);
    }
    const std::uint64_t page_points = std::max<std::uint64_t>(1, limits.page_points);
    std::uint64_t points = 0, pages = 0;
    while (!queue.empty()) {
        const Candidate next = queue.top();
        DetailSelection& selection = scene.trees[next.tree];
        if (!(next.node.error_px * gain(next.tree, next.node.node) > limits.target_px)) {
            if (limits.order == DetailOrder::error) break;  // and so it is with all that follow
            queue.pop();
            selection.beyond.push_back(next.node);
            continue;
        }
        const Node& node = (*trees[next.tree].nodes)[next.node.node];
        std::uint32_t ancestor = next.node.ancestor;
        if (node.points > 0) {
            const std::uint64_t node_pages = (node.points + page_points - 1) / page_points;
            if (points + node.points > limits.point_budget || pages + node_pages > limits.page_budget) {
                selection.budget_reached = scene.budget_reached = true;
                break;
            }
            points += node.points;
            pages += node_pages;
            selection.wanted_points += node.points;
            ancestor = static_cast<std::uint32_t>(selection.wanted.size());
            scene.order.push_back({next.tree, ancestor});
            selection.wanted.push_back(next.node);
        }
        queue.pop();
        for (const NodeId child : node.children)
            if (child != no_node) consider(next.tree, child, ancestor);
    }
    for (; !queue.empty(); queue.pop()) scene.trees[queue.top().tree].beyond.push_back(queue.top().node);
    return scene;
}

DetailSelection select_detail(const std::vector<Node>& nodes, const Grid& grid, const Camera& view,
                              const DetailLimits& limits)
{
    return std::move(select_scene({{&nodes, &grid, view}}, limits).trees.front());
}

DrawSet choose_drawable(const DetailSelection& selection, const std::function<bool(const DetailNode&)>& resident)
{
    DrawSet set;
    std::vector<bool> drawn(selection.wanted.size(), false);
    const auto ancestor_drawn = [&](const DetailNode& node) {
        return node.ancestor == no_ancestor || drawn[node.ancestor];
    };
    const auto count_error = [&](const DetailNode& node) {
        // Below a missing node nothing adds to the error: the box is smaller and the points seen in it are the same.
        if (ancestor_drawn(node)) set.error_px = std::max(set.error_px, node.error_px);
    };
    for (std::uint32_t i = 0; i < selection.wanted.size(); ++i) {
        const DetailNode& node = selection.wanted[i];
        const bool is_resident = resident(node);
        if (!is_resident) set.missing.push_back(i);
        if (is_resident && ancestor_drawn(node)) {
            drawn[i] = true;
            set.drawn.push_back(i);
        } else {
            count_error(node);
        }
    }
    for (const DetailNode& node : selection.beyond) count_error(node);
    set.error_px = std::min(set.error_px, selection.viewport_px);
    return set;
}

}  // namespace pcm
