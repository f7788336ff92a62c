#include "pcm/tree/node_order.h"

#include <algorithm>

namespace pcm {

std::vector<std::uint32_t> divide_into_pages(const std::vector<Node>& nodes)
{
    std::vector<std::uint32_t> pages;
    const auto add = [&](std::size_t subtree) {
        if (pages.empty() || pages.back() + subtree > usual_nodes_of_page) pages.push_back(0);
        pages.back() += static_cast<std::uint32_t>(subtree);
    };
    for (std::size_t first = 0; first < nodes.size();) {
        // A subtree begins at each depth that is a multiple of ten, and the next node of such a depth begins another.
        std::size_t end = first + 1;
        while (end < nodes.size() && nodes[end].depth % depths_of_page != 0 && end - first < usual_nodes_of_page) ++end;
        add(end - first);
        first = end;
    }
    return pages;
}

}  // namespace pcm
