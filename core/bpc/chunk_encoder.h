// Encodes chunks. The layout is in FORMAT.md.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/bpc/chunk_identity.h"
#include "pcm/bpc/double_codes.h"

#include <cstddef>
#include <vector>

namespace pcm {

// A chunk of version 1. `chunk` has at least one point and all its columns. Throws Error(invalid_argument) otherwise.
std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const Grid& grid);
// The same for positions that are codes of doubles: a chunk of version 2, which trees never have.
std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const DoubleCodes& doubles);
// A chunk of a tree: version 3. Its points are sorted by level, with the counts in identity.level_points. A chunk
// without points becomes a tombstone. Sizes are written where the chunk has them.
std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const Grid& grid,
                                    const ChunkIdentity& identity);

}  // namespace pcm
