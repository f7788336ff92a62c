// Some of a chunk's points as a chunk of their own.
#pragma once

#include "pcm/bpc/chunk.h"

#include <cstdint>
#include <vector>

namespace pcm {

// Points `numbers`, in this order, with all the columns that the chunk has. At least one.
Chunk points_of(const Chunk& chunk, const std::vector<std::uint32_t>& numbers);

Box3i box_of(const ChunkPositions& positions);

}  // namespace pcm
