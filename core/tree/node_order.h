// The order of the nodes of a tree: subtrees of ten depths one after another, each breadth first, those nearest to the
// root first. So parents come first, and where each page of the index holds whole subtrees, the nodes from the root
// down to a leaf lie in as many pages as the leaf is tens of depths below.
#pragma once

#include "pcm/tree/node.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace pcm {

inline constexpr unsigned depths_of_page = 10;
inline constexpr std::uint32_t usual_nodes_of_page = 1 << depths_of_page;  // a full subtree, and one node

// The number of nodes of each page: whole subtrees, as many as fit. Nodes in another order give pages of the same size.
std::vector<std::uint32_t> divide_into_pages(const std::vector<Node>& nodes);

// A node in its place: the number of its parent (no_node for the root) and its side below it.
template <class Item>
struct OrderedNode {
    Item item;
    NodeId parent = no_node;
    unsigned side = 0;
};

// `child(item, side)` is the item below another one on a side, 0 or 1; one that is `none` is left out with all below
// it.
template <class Item, class Child>
std::vector<OrderedNode<Item>> order_nodes(const Item& root, const Item& none, const Child& child)
{
    std::vector<OrderedNode<Item>> order;
    std::deque<OrderedNode<Item>> tops{{root}};
    for (; !tops.empty(); tops.pop_front()) {
        std::size_t next = order.size();
        order.push_back(tops.front());
        for (unsigned depth = 1; next < order.size(); ++depth) {
            for (const std::size_t end = order.size(); next < end; ++next)
                for (const unsigned side : {0u, 1u}) {
                    const Item below = child(order[next].item, side);
                    if (below == none) continue;
                    const OrderedNode<Item> placed{below, static_cast<NodeId>(next), side};
                    if (depth < depths_of_page)
                        order.push_back(placed);
                    else
                        tops.push_back(placed);
                }
        }
    }
    return order;
}

// Nodes with their links and depths, and nothing else.
template <class Item>
std::vector<Node> linked_nodes(const std::vector<OrderedNode<Item>>& order)
{
    std::vector<Node> nodes(order.size());
    for (std::size_t id = 1; id < order.size(); ++id) {
        Node& parent = nodes[order[id].parent];
        nodes[id].parent = order[id].parent;
        nodes[id].depth = static_cast<std::uint16_t>(parent.depth + 1);
        parent.children[order[id].side] = static_cast<NodeId>(id);
    }
    return nodes;
}

}  // namespace pcm
