// Chunks with their blocks, kept between searches that look at the same ones.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/knn/point_blocks.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace pcm {

struct HeldChunk {
    NodeId node = no_node;
    L2Cache::Handle handle;
    std::shared_ptr<const PointBlocks> blocks;
    std::size_t points = 0, end_block = 0;  // points of the level asked for
    const ChunkPositions& positions() const { return *handle->positions; }
};

// At most 16 chunks. For one thread.
class HeldChunks {
public:
    HeldChunks(L2Cache& cache, BlockCache& blocks, const std::optional<std::uint16_t>& level)
        : cache_(cache), blocks_(blocks), level_(level)
    {
    }

    const Tree& tree() const { return cache_.tree(); }
    const Grid& grid() const { return tree().info().grid; }
    // Whether the node or its subtree can hold points of the level: finer levels are below a node.
    bool passes(const Node& node) const { return !(level_ && node.points > 0 && node.first_level > *level_); }
    // Valid until the next call. Throws what reading throws.
    const HeldChunk& get(NodeId id);

private:
    L2Cache& cache_;
    BlockCache& blocks_;
    std::optional<std::uint16_t> level_;
    std::array<HeldChunk, 16> held_;
};

// Squared distances from `q` to the boxes [begin, end).
void squares_of(const PointBlocks::Boxes& boxes, std::size_t begin, std::size_t end, const Vec3d& q, double* squares);

}  // namespace pcm
