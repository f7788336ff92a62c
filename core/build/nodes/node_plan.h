// Which levels the nodes of a whole cloud take, before any of them is built.
#pragma once

#include "pcm/build/bins/top_tree.h"
#include "pcm/build/levels/levels_of_bins.h"
#include "pcm/build/levels/sorted_bins.h"
#include "pcm/build/nodes/node_builder.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace pcm {

// A bin, or a node above bins.
struct NodeJob {
    NodePath path;
    std::optional<std::size_t> bin;
    std::array<std::size_t, 2> inputs{};  // job numbers, for a node above bins
    std::vector<std::uint64_t> histogram;
    std::vector<LevelRange> above;  // levels that the nodes above take
    LevelRange own;                 // levels of this node, when it is above bins
};

// In post-order. A side without any points has no job, and then there is no node above; none for a cloud without
// points. `rows`: number of points of a bin.
template <class Coord>
std::vector<NodeJob> plan_nodes(const TopTree<Coord>& top, const std::function<std::uint64_t(std::size_t)>& rows,
                                const LevelsOfBins& levels, std::uint32_t chunk_points);

// The points of a bin, with their levels and sizes. Any thread.
template <class Coord>
LeveledRows leveled_rows(const SortedBins<Coord>& bins, const LevelsOfBins& levels, const NodeBuilderOptions& options,
                         std::size_t bin);

}  // namespace pcm
