#include "pcm/cloud/box_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

constexpr std::uint32_t leaf_size = 8;

}  // namespace

BoxTree::BoxTree(std::vector<Box3d> boxes) : boxes_(std::move(boxes)), order_(boxes_.size())
{
    std::iota(order_.begin(), order_.end(), 0u);
    if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

void BoxTree::build(std::uint32_t first, std::uint32_t last)
{
    const std::size_t at = nodes_.size();
    Box3d around, centres;
    for (std::uint32_t i = first; i < last; ++i) {
        around.extend(boxes_[order_[i]].min);
        around.extend(boxes_[order_[i]].max);
        centres.extend(boxes_[order_[i]].centre());
    }
    nodes_.push_back({around, first, last, 0});
    if (last - first <= leaf_size) return;
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (centres.extent(a) > centres.extent(axis)) axis = a;
    const std::uint32_t half = first + (last - first) / 2;
    std::nth_element(
        order_.begin() + first, order_.begin() + half, order_.begin() + last,
        [&](std::uint32_t a, std::uint32_t b) { return boxes_[a].centre()[axis] < boxes_[b].centre()[axis]; });
    build(first, half);
    nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
    build(half, last);
}

// Those in nodes and at places of order_ that the two say.
template <class NodeHas, class PlaceHas>
std::vector<std::uint32_t> BoxTree::find(const Box3d& box, const NodeHas& node_has, const PlaceHas& place_has) const
{
    std::vector<std::uint32_t> found, open;
    if (!nodes_.empty()) open.push_back(0);
    while (!open.empty()) {
        const std::uint32_t at = open.back();
        open.pop_back();
        const Node& node = nodes_[at];
        if (!node_has(at) || !node.around.intersects(box)) continue;
        if (node.right != 0) {
            open.push_back(at + 1);
            open.push_back(node.right);
            continue;
        }
        for (std::uint32_t i = node.first; i < node.last; ++i)
            if (place_has(i) && boxes_[order_[i]].intersects(box)) found.push_back(order_[i]);
    }
    std::sort(found.begin(), found.end());
    return found;
}

std::vector<std::uint32_t> BoxTree::touching(const Box3d& box) const
{
    const auto any = [](std::uint32_t) { return true; };
    return find(box, any, any);
}

BoxTree::Subset::Subset(const BoxTree& tree)
    : tree_(&tree), place_(tree.order_.size()), has_(tree.order_.size(), 0), below_(tree.nodes_.size(), 0)
{
    for (std::size_t i = 0; i < place_.size(); ++i) place_[tree.order_[i]] = static_cast<std::uint32_t>(i);
}

void BoxTree::Subset::add(std::uint32_t index)
{
    const std::uint32_t place = place_[index];
    has_[place] = 1;
    for (std::uint32_t at = 0;;) {
        below_[at] = 1;
        const std::uint32_t right = tree_->nodes_[at].right;
        if (right == 0) return;
        at = place < tree_->nodes_[right].first ? at + 1 : right;
    }
}

std::vector<std::uint32_t> BoxTree::Subset::touching(const Box3d& box) const
{
    return tree_->find(
        box, [this](std::uint32_t node) { return below_[node] != 0; },
        [this](std::uint32_t place) { return has_[place] != 0; });
}

}  // namespace pcm
