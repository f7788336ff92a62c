// Boxes around short runs of a chunk's points, for searches in compute shaders. No OpenGL here.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/tree/tree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// Points of a chunk lie in Morton order, level by level, so a run of them is compact. Blocks are runs of one level.
struct ChunkBoxes {
    static constexpr std::uint32_t block_points = 32;

    struct Block {
        std::uint32_t first = 0, count = 0;
        std::array<std::uint64_t, 3> low{}, high{};  // tight, relative to the chunk's origin, grid steps
    };
    Vec3i origin{};
    std::vector<Block> blocks;  // of all points, in order

    ChunkBoxes(const ChunkPositions& positions, const Node& node);
    Box3i box(std::size_t block) const;
    // The block that a point is in.
    std::size_t block_of(std::uint32_t point) const;
    std::size_t bytes() const { return blocks.size() * sizeof(Block) + sizeof *this; }
};

// The boxes of consecutive points of a chunk as radii.comp reads them: first of groups of consecutive blocks, about as
// many as a group has blocks, then of the blocks. Of each, in 32-bit words: the low and the high corner, two words per
// coordinate where `wide`, and the range [first, end): of boxes for a group, of points for a block, counted from the
// first point given.
struct PieceBoxes {
    std::vector<std::uint32_t> words;
    std::uint32_t groups = 0, group_blocks = 0;
    std::size_t first_block = 0;  // of the chunk

    PieceBoxes(const ChunkBoxes& chunk, std::uint32_t first, std::uint32_t count, bool wide);
    // The box of a block of the chunk that has points in the piece.
    std::uint32_t box_of(std::size_t block) const { return static_cast<std::uint32_t>(block - first_block) + groups; }
};

}  // namespace pcm
