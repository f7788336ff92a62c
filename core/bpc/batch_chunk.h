// Points of a batch as an encoded chunk, and the points of a decoded chunk in a batch.
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

// Points column by column, owned by somebody else.
struct PointColumns {
    std::size_t size = 0;
    bool gridded = false;
    std::array<const std::int32_t*, 3> grid_xyz{};  // when gridded
    std::array<const double*, 3> xyz{};             // when not
    std::vector<const Column*> attributes;          // each of `size` points
};

// All points of the batch (at least 1, at most 2^32 - 1) in their order. A gridded batch becomes a chunk of version 1
// on `grid`, which it must have; a batch of doubles one of version 2, in which every double keeps its bits. Throws
// Error(invalid_argument) for a batch that is not of this shape.
std::vector<std::byte> encode_batch(const PointBatch& batch, const Schema& schema, const std::optional<Grid>& grid);
std::vector<std::byte> encode_points(const PointColumns& points, const Schema& schema, const std::optional<Grid>& grid);

// Whether the positions of a chunk are integers that a gridded batch can hold.
bool fits_gridded_batch(const BpcHeader& header);

// The coordinates of `count` points from `first`, as doubles; `axis` of a decoded chunk whose header is given.
void positions_to(const BpcHeader& header, const ChunkPositions& positions, std::size_t axis, std::size_t first,
                  std::size_t count, double* to);
// The same as grid positions, where fits_gridded_batch(header).
void positions_to(const BpcHeader& header, const ChunkPositions& positions, std::size_t axis, std::size_t first,
                  std::size_t count, std::int32_t* to);

// The box of the points that the header tells, in source units; none when a coordinate of it is not finite.
std::optional<Box3d> source_box(const BpcHeader& header);

// Bytes that all the columns take when they are decoded.
std::uint64_t decoded_bytes(const BpcHeader& header);

}  // namespace pcm
