// Points as rows of bytes, the form in which the builder moves them: the three grid coordinates, biased so that they
// are unsigned and their order is kept, then the attributes in schema order, nothing between.
//
// Coord is std::uint32_t where every coordinate of the cloud fits in 32 bits (LAS files on one grid), else
// std::uint64_t.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace pcm {

template <class Coord>
inline constexpr Coord coordinate_bias = Coord(1) << (sizeof(Coord) * 8 - 1);

template <class Coord>
Coord to_coordinate(std::int64_t grid)
{
    return static_cast<Coord>(static_cast<Coord>(grid) ^ coordinate_bias<Coord>);
}
template <class Coord>
std::int64_t to_grid(Coord coordinate)
{
    return static_cast<std::make_signed_t<Coord>>(coordinate ^ coordinate_bias<Coord>);
}

struct RowLayout {
    std::size_t coordinate_bytes = 4;  // 4 or 8
    std::vector<std::size_t> offsets;  // of each attribute
    std::vector<std::size_t> sizes;
    std::size_t bytes = 0;

    RowLayout() = default;
    RowLayout(const Schema& schema, bool wide);
};

template <class Coord>
std::array<Coord, 3> coordinates_of(const std::byte* row)
{
    std::array<Coord, 3> c;
    std::memcpy(c.data(), row, sizeof c);
    return c;
}

// As memcpy, without a call: rows are short, and copied one by one.
inline void copy_row(std::byte* to, const std::byte* from, std::size_t bytes)
{
    if (bytes < 16) {
        for (; bytes >= 4; bytes -= 4, to += 4, from += 4) std::memcpy(to, from, 4);
        for (; bytes; --bytes) *to++ = *from++;
        return;
    }
    std::size_t done = 0;
    for (; done + 16 <= bytes; done += 16) std::memcpy(to + done, from + done, 16);
    std::memcpy(to + bytes - 16, from + bytes - 16, 16);
}

// A number for a multiset of rows: the sum of the rows' hashes, so that order does not matter.
std::uint64_t hash_rows(const std::byte* rows, std::size_t count, std::size_t row_bytes);

// The same number for a decoded chunk with all its columns; `scratch` is reused between calls.
std::uint64_t hash_chunk(const Chunk& chunk, const RowLayout& layout, std::vector<std::byte>& scratch);

}  // namespace pcm
