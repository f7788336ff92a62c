// Chunks as bytes: the BPC format. The layout is in FORMAT.md. Versions 1 and 2 are chunks of clouds, version 3 is a
// tree's: it says which node it is of, and its points lie in segments that can be read one by one.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/bpc/chunk_identity.h"
#include "pcm/bpc/double_codes.h"
#include "pcm/system/file.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace pcm {

// Consecutive points of one level. A chunk of version 1 or 2 is one segment.
struct BpcSegment {
    std::uint32_t first = 0;  // the number of its first point in the chunk
    std::uint32_t count = 0;
    std::uint16_t level = 0;
    Box3i box;  // tight around its points, as BpcHeader::box
};

// The bytes of one column of one segment.
struct BpcPiece {
    std::uint64_t offset = 0;  // from the start of the chunk
    std::uint64_t bytes = 0;
    std::uint64_t checksum = 0;
};

struct BpcColumn {
    std::uint64_t offset = 0;  // from the start of the chunk
    std::uint64_t bytes = 0;
    std::vector<BpcPiece> pieces;  // one a segment; none for a constant column
    std::vector<std::uint64_t>
        constant;  // a word a component when all points have the same values, which take no bytes
};

struct BpcHeader {
    std::uint32_t points = 0;  // 0: a tombstone, which says that its node has no points from its generation on
    std::uint32_t header_bytes = 0;
    std::uint64_t total_bytes = 0;
    std::optional<ChunkIdentity> identity;  // of a chunk of version 3
    Grid grid;                              // of a chunk of version 1 or 3
    std::optional<DoubleCodes>
        doubles;        // of a chunk of version 2: its positions are codes of doubles, and `grid` says nothing
    Box3i box;          // tight, of grid positions or codes
    bool wide = false;  // positions take 64 bits an axis when decoded
    std::vector<BpcSegment> segments;
    Schema schema;
    BpcColumn positions;
    std::vector<BpcColumn> attributes;
};

// A segment has at most this many points; in a chunk of more than 16 million a 4096th of them, in whole blocks of 128.
inline constexpr std::uint32_t most_segment_points = 4096;

// A chunk of version 1. `chunk` has at least one point and all its columns. Throws Error(invalid_argument) otherwise.
std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const Grid& grid);
// The same for positions that are codes of doubles: a chunk of version 2, which is part of no tree.
std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const DoubleCodes& doubles);
// A chunk of a tree: version 3. Its points are by level as identity.level_points says. A chunk without points becomes a
// tombstone.
std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const Grid& grid,
                                    const ChunkIdentity& identity);

// Checks magic, version, checksum, that all lies inside `total_bytes`, and that no piece has fewer or more bytes than
// its points can take. `size` may be less than the whole chunk but must cover the header. Throws Error(corrupt |
// unsupported).
BpcHeader decode_header(const std::byte* data, std::size_t size, const std::filesystem::path& path);

// The header of the chunk at `offset` of `file`, of which `available` bytes are there to be read. Throws what
// read_chunk throws.
BpcHeader read_header(const File& file, std::uint64_t offset, std::uint64_t available);

// The chunk of `bytes` bytes at `offset` of `file`: only the asked columns are read and decoded, their checksums
// verified. `header_bytes` is the header's length where the caller knows it, or 0. Throws Error(corrupt | truncated |
// io), naming the file and the byte. Version 2 is Error(unsupported) unless the caller can handle `doubles`.
struct DecodedChunk {
    BpcHeader header;
    Chunk chunk;
};
enum class ChunkPositionsMayBe { on_grid, on_grid_or_doubles };
DecodedChunk read_chunk(const File& file, std::uint64_t offset, std::uint64_t bytes, std::uint32_t header_bytes,
                        const ColumnSet& columns, ChunkPositionsMayBe positions = ChunkPositionsMayBe::on_grid);

// The same of the segments alone for which `wanted` holds, given their box and level; pieces that lie near each other
// come in one read.
struct DecodedPart {
    BpcHeader header;
    Chunk chunk;                      // the points of the kept segments, in their order
    std::vector<std::uint32_t> kept;  // numbers in header.segments
    std::uint64_t bytes_read = 0;     // the header's among them
};
using WantedSegment = std::function<bool(const Box3i& box, std::uint16_t level)>;
DecodedPart read_chunk_part(const File& file, std::uint64_t offset, std::uint64_t bytes, std::uint32_t header_bytes,
                            const ColumnSet& columns, const WantedSegment& wanted);

std::uint64_t checksum(const void* data, std::size_t bytes);  // XXH3, 64 bits

// Attributes and metadata as they stand in headers.
class ByteWriter;
class ByteReader;
void put_attribute(ByteWriter& out, const Attribute& attribute);
Attribute get_attribute(ByteReader& in);

}  // namespace pcm
