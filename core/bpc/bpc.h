// Chunks as bytes: the BPC format. The layout is in FORMAT.md.
#pragma once

#include "bpc/chunk.h"
#include "bpc/double_codes.h"
#include "cloud/file.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// The way from the root to a node: bit i of the 128 tells which child is taken at depth i.
struct NodePath {
    static constexpr std::uint16_t max_depth = 128;
    std::uint16_t depth = 0;
    std::array<std::uint64_t, 2> bits{0, 0};

    NodePath child(unsigned side) const
    {
        NodePath path = *this;
        if (side) path.bits[depth / 64] |= std::uint64_t(1) << (depth % 64);
        ++path.depth;
        return path;
    }
    bool operator==(const NodePath& o) const { return depth == o.depth && bits == o.bits; }
};

struct BpcColumn {
    std::uint64_t offset = 0;  // from the start of the chunk
    std::uint64_t bytes = 0;
    std::uint64_t checksum = 0;
};

struct BpcHeader {
    std::uint32_t points = 0;
    std::uint32_t header_bytes = 0;
    std::uint64_t total_bytes = 0;
    NodePath path;
    Grid grid;                         // of a chunk of version 1
    std::optional<DoubleCodes> doubles;  // of a chunk of version 2: its positions are codes of doubles, and `grid` says nothing
    Box3i box;                         // tight, of grid positions or codes
    bool wide = false;                 // positions take 64 bits an axis when decoded
    Schema schema;
    BpcColumn positions;
    std::vector<BpcColumn> attributes;
};

// `chunk` has at least one point and all its columns. Throws Error(invalid_argument) otherwise.
std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const Grid& grid, const NodePath& path);
// The same for positions that are codes of doubles: a chunk of version 2, which is part of no tree.
std::vector<std::byte> encode_chunk(const Chunk& chunk, const Schema& schema, const DoubleCodes& doubles);

// Checks magic, version, checksum, that all lies inside `total_bytes`, and that no column has fewer or more bytes than its
// points can take. `size` may be less than the whole chunk but must cover the header. Throws Error(corrupt | unsupported).
BpcHeader decode_header(const std::byte* data, std::size_t size, const std::filesystem::path& path);

// The header of the chunk at `offset` of `file`, of which `available` bytes are there to be read. Throws what read_chunk throws.
BpcHeader read_header(const File& file, std::uint64_t offset, std::uint64_t available);

// The chunk of `bytes` bytes at `offset` of `file`: only the asked columns are read and decoded, their checksums verified.
// `header_bytes` is the header's length where the caller knows it, or 0. Throws Error(corrupt | truncated | io), naming the file
// and the byte. Version 2 is Error(unsupported) unless the caller can handle `doubles`.
struct DecodedChunk {
    BpcHeader header;
    Chunk chunk;
};
enum class ChunkPositionsMayBe { on_grid, on_grid_or_doubles };
DecodedChunk read_chunk(const File& file, std::uint64_t offset, std::uint64_t bytes, std::uint32_t header_bytes,
                        const ColumnSet& columns, ChunkPositionsMayBe positions = ChunkPositionsMayBe::on_grid);

std::uint64_t checksum(const void* data, std::size_t bytes);  // XXH3, 64 bits

// Attributes and metadata as they stand in headers.
class ByteWriter;
class ByteReader;
void put_attribute(ByteWriter& out, const Attribute& attribute);
Attribute get_attribute(ByteReader& in);

}  // namespace pcm
