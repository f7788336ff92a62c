#include "pcm/view/level_of_detail.h"

#include "pcm/cloud/numbers.h"

#include <algorithm>
#include <optional>
#include <queue>
#include <unordered_map>
#include <utility>

namespace pcm {
namespace {

// One selection: a queue of the visible nodes whose ancestors are all wanted or have no points.
class Selecting {
public:
    Selecting(const std::vector<TreeInView>& trees, const DetailLimits& limits)
        : trees_(trees), limits_(limits), page_points_(std::max<std::uint64_t>(1, limits.page_points))
    {
        frusta_.resize(trees.size());
        scene_.trees.resize(trees.size());
    }

    SceneSelection run()
    {
        for (std::uint32_t t = 0; t < trees_.size(); ++t) {
            frusta_[t] = Frustum::of(trees_[t].view);
            if (!frusta_[t] || trees_[t].nodes->empty()) continue;
            scene_.trees[t].viewport_px = std::max(trees_[t].view.width, trees_[t].view.height);
            consider(t, 0, no_node, no_ancestor);
        }
        while (!queue_.empty() && take(queue_.top())) {
        }
        for (; !queue_.empty(); queue_.pop()) scene_.trees[queue_.top().tree].beyond.push_back(queue_.top().node);
        return std::move(scene_);
    }

private:
    struct Candidate {
        double rank;
        std::uint32_t tree;
        DetailNode node;
        const Node* read;  // null: it has not been
        bool operator<(const Candidate& other) const
        {
            if (rank != other.rank) return rank < other.rank;
            return tree != other.tree ? tree > other.tree : node.node > other.node.node;
        }
    };

    // A node without points is never drawn: for its descendants, it counts as kept. So does one that has not been read
    // (null).
    double gain(std::uint32_t tree, NodeId id, const Node* node) const
    {
        return limits_.kept && (!node || node->points == 0 || limits_.kept(tree, id)) ? DetailLimits::kept_gain : 1.0;
    }

    void consider(std::uint32_t tree, NodeId id, NodeId parent, std::uint32_t ancestor)
    {
        const NodeTable& nodes = *trees_[tree].nodes;
        const Node* const node = trees_[tree].waits ? &nodes[id] : nodes.find(id);
        if (node && node->subtree_points == 0) return;
        const Box3d box = trees_[tree].grid->to_source(node ? node->box : nodes[parent].box);
        if (!frusta_[tree]->intersects(box)) return;
        const std::vector<Clip>* const clips = trees_[tree].clips;
        if (clips && relation_of(*clips, box) == BoxRelation::outside) return;
        const double error = ancestor == no_ancestor ? infinity : frusta_[tree]->pixels(nodes[parent].spacing, box);
        const double rank = limits_.order == DetailOrder::error ? error * gain(tree, id, node)
                            : parent == no_node                 ? 0
                                                                : -(nodes[parent].depth + 1.0);
        queue_.push({rank, tree, {id, parent, ancestor, error}, node});
    }

    // The best candidate; false when the selection ends with it.
    bool take(const Candidate next)
    {
        DetailSelection& selection = scene_.trees[next.tree];
        if (!(next.node.error_px * gain(next.tree, next.node.node, next.read) > limits_.target_px)) {
            if (limits_.order == DetailOrder::error) return false;  // all that follow are below the target too
            queue_.pop();
            selection.beyond.push_back(next.node);
            return true;
        }
        if (!next.read) {
            queue_.pop();
            selection.unread.push_back(next.node);
            return true;
        }
        const Node& node = *next.read;
        std::uint32_t ancestor = next.node.ancestor;
        if (node.points > 0) {
            const std::uint64_t node_pages = (node.points + page_points_ - 1) / page_points_;
            if (points_ + node.points > limits_.point_budget || pages_ + node_pages > limits_.page_budget) {
                selection.budget_reached = scene_.budget_reached = true;
                return false;
            }
            points_ += node.points;
            pages_ += node_pages;
            selection.wanted_points += node.points;
            ancestor = static_cast<std::uint32_t>(selection.wanted.size());
            scene_.order.push_back({next.tree, ancestor});
            selection.wanted.push_back(next.node);
        }
        queue_.pop();
        for (const NodeId child : node.children)
            if (child != no_node) consider(next.tree, child, next.node.node, ancestor);
        return true;
    }

    const std::vector<TreeInView>& trees_;
    const DetailLimits& limits_;
    const std::uint64_t page_points_;
    std::vector<std::optional<Frustum>> frusta_;
    std::priority_queue<Candidate> queue_;
    SceneSelection scene_;
    std::uint64_t points_ = 0, pages_ = 0;
};

}  // namespace

SceneSelection select_scene(const std::vector<TreeInView>& trees, const DetailLimits& limits)
{
    return Selecting(trees, limits).run();
}

DetailSelection select_detail(const NodeTable& nodes, const Grid& grid, const Camera& view, const DetailLimits& limits)
{
    return std::move(select_scene({{&nodes, &grid, view, nullptr}}, limits).trees.front());
}

bool SceneSelection::lacks_nodes() const
{
    return std::any_of(trees.begin(), trees.end(), [](const DetailSelection& tree) { return !tree.unread.empty(); });
}

void put_first(const SceneSelection& first, SceneSelection& selection)
{
    std::vector<std::unordered_map<NodeId, std::uint32_t>> places(selection.trees.size());
    std::vector<std::vector<bool>> is_first(selection.trees.size());
    for (std::size_t t = 0; t < places.size(); ++t) {
        const std::vector<DetailNode>& wanted = selection.trees[t].wanted;
        for (std::uint32_t i = 0; i < wanted.size(); ++i) places[t].emplace(wanted[i].node, i);
        is_first[t].assign(wanted.size(), false);
    }
    std::vector<SceneSelection::Place> order;
    for (const SceneSelection::Place& place : first.order) {
        const std::uint32_t index = places[place.tree].at(first.trees[place.tree].wanted[place.index].node);
        is_first[place.tree][index] = true;
        order.push_back({place.tree, index});
    }
    for (const SceneSelection::Place& place : selection.order)
        if (!is_first[place.tree][place.index]) order.push_back(place);
    selection.order = std::move(order);
}

DrawSet choose_drawable(const DetailSelection& selection, const std::function<bool(const DetailNode&)>& resident)
{
    DrawSet set;
    std::vector<bool> drawn(selection.wanted.size(), false);
    const auto ancestor_drawn = [&](const DetailNode& node) {
        return node.ancestor == no_ancestor || drawn[node.ancestor];
    };
    const auto count_error = [&](const DetailNode& node) {
        // Descendants of a missing node add nothing to the error: their boxes are smaller, and show the same points.
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
    for (const DetailNode& node : selection.unread) count_error(node);
    for (const DetailNode& node : selection.beyond) count_error(node);
    set.error_px = std::min(set.error_px, selection.viewport_px);
    return set;
}

}  // namespace pcm
