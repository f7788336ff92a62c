// Which nodes of a tree a view needs, and the error of a picture drawn without some of them. No OpenGL here.
//
// The measure is the *projected spacing*: the distance, in pixels, at which neighbouring points appear. While a node is
// not drawn, its box is filled by its ancestors alone, whose points lie `nodes[parent].spacing` apart; projected at the
// point of the node's box nearest to the eye, that is the node's `error_px`. Drawing the node removes the error (its
// children's errors remain). The same holds for perspective and orthographic views.
//
// All functions are pure: the same arguments give the same result on any thread.
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/tree/tree.h"
#include "pcm/view/frustum.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

enum class DetailOrder : std::uint8_t {
    error,  // best first: descending error
    depth,  // the root, then all of depth 1, ...: coarse nodes first, whatever their error (for comparison)
};

struct DetailLimits {
    double target_px = 1.4;                   // nodes with an error at or below this are not wanted
    std::uint64_t point_budget = 20'000'000;  // maximum points of all wanted nodes together
    // Video memory is allocated to nodes in pages of page_points points; the wanted nodes need at most page_budget.
    std::uint32_t page_points = 4096;
    std::uint64_t page_budget = ~std::uint64_t(0);
    DetailOrder order = DetailOrder::error;
    // Hysteresis: the error of a node for which `kept` returns true is multiplied by kept_gain, in the order and
    // against the target, so that nodes drawn in the last frame are not replaced by nodes that are hardly better. No
    // hysteresis when empty.
    std::function<bool(std::uint32_t tree, NodeId node)> kept;
    static constexpr double kept_gain = 1.25;
};

inline constexpr std::uint32_t no_ancestor = 0xffffffffu;

// A visible node that the selection visited. A node without points of its own is never wanted, but its descendants may
// be.
struct DetailNode {
    NodeId node = no_node;
    NodeId parent = no_node;
    std::uint32_t ancestor = no_ancestor;  // index in `wanted` of the nearest ancestor that has points
    // In its box while it is not drawn; infinite without an ancestor. Where the node has not been read, in its parent's
    // box, which is no less.
    double error_px = 0;
};

struct DetailSelection {
    std::vector<DetailNode> wanted;  // best first; an ancestor stands before its descendants
    // Visible and not wanted, because below the target or over the budget; the nearest ancestor with points is wanted.
    std::vector<DetailNode> beyond;
    // What the selection lacks: nodes above the target that have not been read, best first, of a tree of which only
    // those are used that have been. Their parents are visible, they themselves may not be.
    std::vector<DetailNode> unread;
    std::uint64_t wanted_points = 0;
    bool budget_reached = false;  // a node above the target did not fit the budget
    double viewport_px = 0;       // the larger side of the viewport
};

// One of several trees in a picture. `view` has the projection and size of the scene, and the tree's own modelview and
// origin.
struct TreeInView {
    const NodeTable* nodes = nullptr;
    const Grid* grid = nullptr;
    Camera view;
    const std::vector<Clip>* clips = nullptr;  // nodes of which they leave nothing are left out
    bool waits = true;  // for nodes to be read; else those that have not been are left out, and listed
};

// The selection of each tree, and the order of the wanted nodes of all trees.
struct SceneSelection {
    struct Place {
        std::uint32_t tree;
        std::uint32_t index;  // in its `wanted`
    };
    std::vector<DetailSelection> trees;
    std::vector<Place> order;
    bool budget_reached = false;

    bool lacks_nodes() const;  // some have not been read
};

// Selects nodes over all trees in the limits' order (ties: lower tree, then lower node number), children only after
// their parent, until no error is above the target or the next node does not fit the budget; nodes outside the view, or
// clipped as a whole, are left out. The selection under a budget is therefore a prefix of the selection without one.
// Nodes must have parents before children. O(n log n) in the number of nodes that are visible and above the target.
SceneSelection select_scene(const std::vector<TreeInView>& trees, const DetailLimits& limits);

// The same for one tree.
DetailSelection select_detail(const NodeTable& nodes, const Grid& grid, const Camera& view, const DetailLimits& limits);
inline DetailSelection select_detail(const Tree& tree, const Camera& view, const DetailLimits& limits)
{
    return select_detail(tree.nodes(), tree.info().grid, view, limits);
}

// Puts the nodes that `first` wants to the front of the selection's order, in the order of `first`: a selection of the
// same view, at most as detailed, that was made when no more nodes had been read.
void put_first(const SceneSelection& first, SceneSelection& selection);

struct DrawSet {
    std::vector<std::uint32_t> drawn;    // indices in `wanted`, in its order
    std::vector<std::uint32_t> missing;  // wanted, not resident; in the order of `wanted`
    // The largest error of a visible node that is not drawn, at most the viewport's larger side (the error of a view
    // without its root); 0 when everything visible is drawn in full.
    double error_px = 0;
};

// The drawable part of a selection: resident nodes whose ancestors are all drawn. So no node is visible before coarser
// ones, the density stays even, and a drawn node stays until it leaves the view or the cache. `resident` is called once
// for every wanted node, in order.
DrawSet choose_drawable(const DetailSelection& selection, const std::function<bool(const DetailNode&)>& resident);

}  // namespace pcm
