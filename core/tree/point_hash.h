// The content hash of a tree: one number for the multiset of its points with all their attributes, independent of their
// order. It is the sum of the checksums of the points' rows; bpc/FORMAT.md defines it.
//
// A point's row is its bytes in one piece: the three grid coordinates, biased so that they are unsigned and keep their
// order, then the attributes in schema order, without gaps. Coord is std::uint32_t where every coordinate of the cloud
// fits in 32 bits (LAS files on one grid), else std::uint64_t.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/attribute.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

template <class Coord>
inline constexpr Coord coordinate_bias = Coord(1) << (sizeof(Coord) * 8 - 1);

template <class Coord>
Coord to_coordinate(std::int64_t grid)
{
    return static_cast<Coord>(static_cast<Coord>(grid) ^ coordinate_bias<Coord>);
}

struct RowLayout {
    std::size_t coordinate_bytes = 4;  // 4 or 8
    std::vector<std::size_t> offsets;  // byte offset of each attribute
    std::vector<std::size_t> sizes;
    std::size_t bytes = 0;

    RowLayout() = default;
    RowLayout(const Schema& schema, bool wide);
};

// The sum of the rows' checksums.
std::uint64_t hash_rows(const std::byte* rows, std::size_t count, std::size_t row_bytes);

// The same number for a decoded chunk with all its columns; `scratch` is reused between calls.
std::uint64_t hash_chunk(const Chunk& chunk, const RowLayout& layout, std::vector<std::byte>& scratch);

}  // namespace pcm
