// Boxes around short runs of a chunk's points, so that a search looks at few of them.
#pragma once

#include "pcm/tree/tree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcm {

// Points of a chunk lie in Morton order, level by level, so a run of them is compact. Blocks are runs of one level,
// groups are runs of blocks. Boxes are in source coordinates, and tight.
struct PointBlocks {
    static constexpr std::size_t block_points = 64, group_blocks = 32;

    struct Boxes {  // one column per bound
        std::array<std::vector<double>, 3> min, max;
        std::size_t size() const { return min[0].size(); }
        Box3d box(std::size_t i) const
        {
            return {{min[0][i], min[1][i], min[2][i]}, {max[0][i], max[1][i], max[2][i]}};
        }
        void add(const Box3d& box);
    };
    Boxes blocks, groups;
    std::vector<std::uint32_t> first;        // point of each block, and the number of points at the end
    std::vector<std::uint32_t> group_first;  // block of each group, and the number of blocks at the end

    PointBlocks(const ChunkPositions& positions, const Node& node, const Grid& grid);
    std::size_t bytes() const;
};

// Blocks of the most recently used chunks, at most `capacity` bytes of them. Any number of threads.
class BlockCache {
public:
    explicit BlockCache(std::size_t capacity = std::size_t(64) << 20) : capacity_(capacity) {}
    std::shared_ptr<const PointBlocks> get(NodeId node, const Tree& tree, const ChunkPositions& positions);

private:
    using Entry = std::pair<NodeId, std::shared_ptr<const PointBlocks>>;
    const std::size_t capacity_;
    std::mutex mutex_;
    std::list<Entry> used_;  // most recently used first
    std::unordered_map<NodeId, std::list<Entry>::iterator> places_;
    std::size_t bytes_ = 0;
};

}  // namespace pcm
