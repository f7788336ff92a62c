// Sums over the points of a tree by several threads, the same ones whatever the threads.
#pragma once

#include "pcm/threads/for_each_index.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

namespace pcm {

inline constexpr std::size_t node_groups = 64;  // groups of nodes, whose parts are added in order

// Calls see(part, node) for all nodes with points, by all threads, those of one group by one, whose part begins as
// Part(); then add(part) for the parts in the order of the groups, by one thread at a time, and as soon as those before
// are there, so that few are held. `tick` is given the share that is begun, on the calling thread, and may throw; what
// any of them throws ends the work.
template <class Part, class See, class Add, class Tick>
void sum_over_nodes(const Tree& tree, unsigned threads, const See& see, const Add& add, const Tick& tick)
{
    const std::size_t nodes = tree.nodes().size();
    std::vector<Part> open(node_groups);
    std::vector<bool> done(node_groups, false);
    std::size_t next = 0;
    std::mutex mutex;
    for_each_index(
        node_groups, threads,
        [&](std::size_t g, const Stop& stop) {
            for (std::size_t n = g * nodes / node_groups; n < (g + 1) * nodes / node_groups && !stop.asked(); ++n) {
                const auto node = static_cast<NodeId>(n);
                if (tree.node(node).points > 0) see(open[g], node);
            }
            if (stop.asked()) return;
            const std::lock_guard lock(mutex);
            done[g] = true;
            for (; next < node_groups && done[next]; ++next) add(std::exchange(open[next], Part()));
        },
        [&](std::size_t begun) { tick(static_cast<double>(begun) / static_cast<double>(node_groups)); });
}

}  // namespace pcm
