// Which nodes of a tree a view needs, and how well what is drawn serves it. No OpenGL here.
//
// The measure is the *projected spacing*: how far apart, in pixels, neighbouring points appear. While a node is not
// drawn, its box is filled by its ancestors alone, whose points lie `nodes[parent].spacing` apart; projected at the
// point of the node's box that is nearest to the eye, that is the node's `error_px`. Drawing the node takes the error
// away (what is left is the error of its children). Perspective and orthographic views are handled alike.
//
// All functions are pure: the same arguments give the same result on any thread.
#pragma once

#include "pcm/tree/tree.h"
#include "pcm/view/frustum.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

enum class DetailOrder : std::uint8_t {
    error,  // best first: falling error
    depth,  // the root, then all of depth 1, ...; what is coarser first whatever it is worth (for comparison)
};

struct DetailLimits {
    double target_px = 1.4;                   // no node is wanted for an error at or below this
    std::uint64_t point_budget = 20'000'000;  // of all wanted nodes together
    // Video memory is given out in pages of page_points points to a node; the wanted nodes need at most page_budget.
    std::uint32_t page_points = 4096;
    std::uint64_t page_budget = ~std::uint64_t(0);
    DetailOrder order = DetailOrder::error;
    // Hysteresis: a node for which `kept` says so counts as if its error were so many times larger, in the order and
    // against the target, so that what was drawn in the last frame is not given up for what is hardly better. None when
    // empty.
    std::function<bool(std::uint32_t tree, NodeId node)> kept;
    static constexpr double kept_gain = 1.25;
};

inline constexpr std::uint32_t no_ancestor = 0xffffffffu;

// A visible node that the selection came by. A node without points of its own is never wanted, only what is below it.
struct DetailNode {
    NodeId node = no_node;
    std::uint32_t ancestor = no_ancestor;  // index in `wanted` of the nearest ancestor that has points
    double error_px = 0;                   // in its box while it is not drawn; infinite when there is no ancestor
};

struct DetailSelection {
    std::vector<DetailNode> wanted;  // best first; an ancestor stands before its descendants
    std::vector<DetailNode>
        beyond;  // visible, ancestor wanted (or none), not wanted: below the target or over the budget
    std::uint64_t wanted_points = 0;
    bool budget_reached = false;  // a node above the target was left out for want of budget
    double viewport_px = 0;       // the larger side of the viewport
};

// One tree of several that share a picture. `view` has the scene's projection and size, and a modelview and an origin
// of the tree's own.
struct TreeInView {
    const std::vector<Node>* nodes = nullptr;
    const Grid* grid = nullptr;
    Camera view;
};

// What is wanted of each tree, and in which order of all.
struct SceneSelection {
    struct Place {
        std::uint32_t tree;
        std::uint32_t index;  // in its `wanted`
    };
    std::vector<DetailSelection> trees;
    std::vector<Place> order;
    bool budget_reached = false;
};

// Best first over all trees, that is in the limits' order (ties: lower tree, lower node number first), children only
// after their parent, until no error is above the target or the next best node does not fit the budget; nodes outside
// the view are left out. So what is wanted under a budget is a beginning of what is wanted without. Nodes must have
// parents before children. O(n log n) in the number of nodes that are visible and above the target.
SceneSelection select_scene(const std::vector<TreeInView>& trees, const DetailLimits& limits);

// Of one tree.
DetailSelection select_detail(const std::vector<Node>& nodes, const Grid& grid, const Camera& view,
                              const DetailLimits& limits);
inline DetailSelection select_detail(const Tree& tree, const Camera& view, const DetailLimits& limits)
{
    return select_detail(tree.nodes(), tree.info().grid, view, limits);
}

struct DrawSet {
    std::vector<std::uint32_t> drawn;    // indices in `wanted`, in its order
    std::vector<std::uint32_t> missing;  // wanted, not resident; in the order of `wanted`
    // The largest error of a visible node that is not drawn, at most the viewport's larger side (which is what a view
    // without its root counts as); 0 when everything visible is drawn in full.
    double error_px = 0;
};

// What can be drawn of a selection: a resident node whose ancestors are all drawn. So nothing is seen before what is
// coarser than it, the density stays even, and a node that was drawn stays until the view or the cache lets go of it.
// `resident` is asked once for every wanted node, in order.
DrawSet choose_drawable(const DetailSelection& selection, const std::function<bool(const DetailNode&)>& resident);

}  // namespace pcm
