// The header of a chunk, decoded: what the chunk holds and where its bytes are. The layout is in FORMAT.md. Versions 1
// and 2 are chunks of clouds. Version 3 is a chunk of a tree: it names its node, and its points are stored in segments
// that can be read one by one.
#pragma once

#include "pcm/bpc/chunk_identity.h"
#include "pcm/bpc/double_codes.h"
#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/system/byte_source.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
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
    std::vector<BpcPiece> pieces;  // one per segment; none for a constant column
    // One word per component when all points have the same values; a constant column takes no bytes.
    std::vector<std::uint64_t> constant;
};

struct BpcHeader {
    std::uint32_t points = 0;  // 0: a tombstone, whose node has no points from its generation on
    std::uint32_t header_bytes = 0;
    std::uint64_t total_bytes = 0;
    std::optional<ChunkIdentity> identity;  // version 3 only
    Grid grid;                              // versions 1 and 3
    std::optional<DoubleCodes> doubles;     // version 2: positions are codes of doubles, and `grid` has no meaning
    Box3i box;                              // tight, of grid positions or codes
    bool wide = false;                      // decoded positions have 64 bits per axis
    std::vector<BpcSegment> segments;
    Schema schema;
    BpcColumn positions;
    std::vector<BpcColumn> attributes;
    std::optional<BpcColumn> sizes;  // point sizes; version 3
};

// Checks magic, version and checksum, that every piece lies inside `total_bytes`, and that no piece has fewer or more
// bytes than its points can take. `size` may be less than the whole chunk but must cover the header. Throws
// Error(corrupt | unsupported).
BpcHeader decode_header(const std::byte* data, std::size_t size, const std::filesystem::path& path);

// The header of the chunk at `offset` of `file`, where `available` bytes can be read. Throws what decode_header throws
// and Error(truncated | io), naming the file and the byte.
BpcHeader read_header(const ByteSource& file, std::uint64_t offset, std::uint64_t available);

}  // namespace pcm
