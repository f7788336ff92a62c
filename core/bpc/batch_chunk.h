// Conversion between batches of points and chunks.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/bpc/chunk_header.h"
#include "pcm/cloud/point_batch.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// Points column by column; the caller owns the columns.
struct PointColumns {
    std::size_t size = 0;
    bool gridded = false;
    std::array<const std::int32_t*, 3> grid_xyz{};  // when gridded
    std::array<const double*, 3> xyz{};             // when not
    std::vector<const Column*> attributes;          // each of `size` points
};

// Encodes all points of the batch (1 to 2^32 - 1) in their order. A gridded batch becomes a chunk of version 1 on
// `grid`, which must be present; a batch of doubles becomes a chunk of version 2, which keeps every bit of them. Throws
// Error(invalid_argument) for a batch of another shape.
std::vector<std::byte> encode_batch(const PointBatch& batch, const Schema& schema, const std::optional<Grid>& grid);
std::vector<std::byte> encode_points(const PointColumns& points, const Schema& schema, const std::optional<Grid>& grid);

// Whether the positions of a chunk are integers that a gridded batch can hold.
bool fits_gridded_batch(const BpcHeader& header);

// The coordinates on `axis` of `count` points from `first`, as doubles, of a decoded chunk with this header.
void positions_to(const BpcHeader& header, const ChunkPositions& positions, std::size_t axis, std::size_t first,
                  std::size_t count, double* to);
// The same as grid positions; requires fits_gridded_batch(header).
void positions_to(const BpcHeader& header, const ChunkPositions& positions, std::size_t axis, std::size_t first,
                  std::size_t count, std::int32_t* to);

// The header's box in source units; none when one of its coordinates is not finite.
std::optional<Box3d> source_box(const BpcHeader& header);

// Size of all columns when decoded.
std::uint64_t decoded_bytes(const BpcHeader& header);

}  // namespace pcm
