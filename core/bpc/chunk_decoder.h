// Reads chunks from a file: whole chunks or some of their segments, and only the columns that the caller asks for.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/bpc/chunk_header.h"
#include "pcm/system/byte_source.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

struct DecodedChunk {
    BpcHeader header;
    Chunk chunk;
    std::uint64_t bytes_read = 0;  // the header included
};
enum class ChunkPositionsMayBe { on_grid, on_grid_or_doubles };
// Reads the chunk of `bytes` bytes at `offset` of `file`. Only the columns in `columns` are read and decoded; their
// checksums are verified. `at_first` is how many bytes are read at once from the chunk's beginning: at least its header
// where the caller knows its length, or 0; with the columns that the caller expects to follow, no second read is
// necessary. Throws Error(corrupt | truncated | io), naming the file and the byte. Version 2 is Error(unsupported)
// unless `positions` allows doubles.
DecodedChunk read_chunk(const ByteSource& file, std::uint64_t offset, std::uint64_t bytes, std::uint64_t at_first,
                        const ColumnSet& columns, ChunkPositionsMayBe positions = ChunkPositionsMayBe::on_grid);

// The same for a chunk whose `bytes` bytes were read from `offset` of `file` before; codec_slack readable bytes follow
// them.
DecodedChunk decode_chunk(const std::byte* chunk, std::uint64_t bytes, const ByteSource& file, std::uint64_t offset,
                          const ColumnSet& columns);

struct DecodedPart {
    BpcHeader header;
    Chunk chunk;                      // the points of the kept segments, in their order
    std::vector<std::uint32_t> kept;  // numbers in header.segments
    std::uint64_t bytes_read = 0;     // the header included
};
using WantedSegment = std::function<bool(const Box3i& box, std::uint16_t level)>;
// The same for the segments for which `wanted` returns true. Pieces that lie near each other are read together.
DecodedPart read_chunk_part(const ByteSource& file, std::uint64_t offset, std::uint64_t bytes, std::uint64_t at_first,
                            const ColumnSet& columns, const WantedSegment& wanted);

}  // namespace pcm
