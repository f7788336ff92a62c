// Copies of values that lie a fixed number of bytes apart.
#pragma once

#include <cstddef>
#include <cstring>

namespace pcm {

template <std::size_t Bytes>
void copy_strided(const std::byte* from, std::size_t from_step, std::byte* to, std::size_t to_step, std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * to_step, from + i * from_step, Bytes);
}

// Copies `count` values of `bytes` bytes each; frequent sizes by a copy of a length that the compiler knows.
inline void copy_strided(std::size_t bytes, const std::byte* from, std::size_t from_step, std::byte* to,
                         std::size_t to_step, std::size_t count)
{
    switch (bytes) {
        case 1:
            return copy_strided<1>(from, from_step, to, to_step, count);
        case 2:
            return copy_strided<2>(from, from_step, to, to_step, count);
        case 3:
            return copy_strided<3>(from, from_step, to, to_step, count);
        case 4:
            return copy_strided<4>(from, from_step, to, to_step, count);
        case 6:
            return copy_strided<6>(from, from_step, to, to_step, count);
        case 8:
            return copy_strided<8>(from, from_step, to, to_step, count);
        case 10:  // angle, user data, source and colour of a LAS record
            return copy_strided<10>(from, from_step, to, to_step, count);
        case 12:
            return copy_strided<12>(from, from_step, to, to_step, count);
        default:
            for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * to_step, from + i * from_step, bytes);
    }
}

}  // namespace pcm
