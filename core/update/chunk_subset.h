// Some points of a chunk as a chunk of their own.
#pragma once

#include "pcm/bpc/chunk.h"

#include <cstdint>
#include <vector>

namespace pcm {

// The points with these numbers, in this order, with all columns that the chunk has. At least one point.
Chunk subset_of(const Chunk& chunk, const std::vector<std::uint32_t>& numbers);

// Tight around the positions.
Box3i box_of(const ChunkPositions& positions);

}  // namespace pcm
