// The parts of a cloud's file that are not chunks: the cloud block before the chunks and the chunk table after them.
// The layout of both is in FORMAT.md.
#pragma once

#include "pcm/bpc/chunk_index.h"
#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/metadata.h"
#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace pcm {

struct BpcCloud {
    std::uint64_t points = 0;
    std::uint64_t chunks = 0;
    ScalarType position_type = ScalarType::f64;  // type in the source: i32 on a grid, else f32 or f64
    std::optional<Grid> grid;                    // when all chunks are on it and their integers fit 32 bits
    std::optional<Box3d> box;                    // none when there are no points or a coordinate is not finite
    Schema schema;
    std::vector<Metadata> metadata;
};

// A block is read in one piece, so its size is limited; a larger one is not written either.
inline constexpr std::uint64_t most_cloud_block_bytes = std::uint64_t{96} << 20;
inline constexpr std::string_view cloud_block_magic = "BPCLOUD\n";

// Throws Error(unsupported) when the block would have more than most_cloud_block_bytes. Its length does not depend on
// the numbers of points and chunks, the box and the table's place, which are known, and written, last.
std::vector<std::byte> encode_cloud_block(const BpcCloud& cloud, std::uint64_t table_offset);

struct CloudBlock {
    BpcCloud cloud;
    std::uint64_t bytes = 0;  // size of the block; the first chunk begins here
    std::uint64_t table_offset = 0;
};
// Whether the file begins with a cloud block.
bool has_cloud_block(const File& file);
// Throws Error(truncated | corrupt | unsupported), naming the file.
CloudBlock read_cloud_block(const File& file, std::uint64_t file_bytes);

struct ChunkSize {
    std::uint64_t points = 0;
    std::uint64_t bytes = 0;
};
std::vector<std::byte> encode_chunk_table(const std::vector<ChunkSize>& chunks);
// Checks that the table ends the file, that its checksum holds, and that it agrees with the block. Throws as
// read_cloud_block.
ChunkIndex read_chunk_table(const File& file, std::uint64_t file_bytes, const CloudBlock& block);

}  // namespace pcm
