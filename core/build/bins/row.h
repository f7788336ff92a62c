// Points as rows of bytes, the form in which the builder moves them; the row is the one of tree/point_hash.h.
#pragma once

#include "pcm/tree/point_hash.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace pcm {

template <class Coord>
std::int64_t to_grid(Coord coordinate)
{
    return static_cast<std::make_signed_t<Coord>>(coordinate ^ coordinate_bias<Coord>);
}

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

// Copies the rows numbered `order`, which may be far apart in memory, one after the other to `to`.
inline void gather_rows(const std::byte* rows, const std::uint32_t* order, std::size_t count, std::size_t row_bytes,
                        std::byte* to)
{
    constexpr std::size_t ahead = 16;  // rows on their way to the cache
    for (std::size_t i = 0; i < count; ++i) {
        if (i + ahead < count) {
            const std::byte* coming = rows + order[i + ahead] * row_bytes;
            __builtin_prefetch(coming);
            __builtin_prefetch(coming + row_bytes - 1);
        }
        copy_row(to + i * row_bytes, rows + order[i] * row_bytes, row_bytes);
    }
}

}  // namespace pcm
