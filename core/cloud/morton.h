// Morton codes (Z order): the bits of three coordinates in turn, so that cells with close codes lie close together.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcm {

inline constexpr int morton_axis_bits = 21;  // three axes fit 64 bits

namespace detail {
// Seven bits, each followed by two zero bits.
constexpr std::array<std::uint32_t, 128> make_spread_bits()
{
    std::array<std::uint32_t, 128> spread{};
    for (std::uint32_t v = 0; v < 128; ++v)
        for (std::uint32_t bit = 0; bit < 7; ++bit) spread[v] |= (v >> bit & 1) << (3 * bit);
    return spread;
}
inline constexpr std::array<std::uint32_t, 128> spread_bits = make_spread_bits();
}  // namespace detail

// The low 21 bits of v, each followed by two zero bits: one axis of a Morton code. The code of a cell is
// spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2.
inline std::uint64_t spread_bits(std::uint64_t v)
{
    return detail::spread_bits[v & 127] | static_cast<std::uint64_t>(detail::spread_bits[v >> 7 & 127]) << 21 |
           static_cast<std::uint64_t>(detail::spread_bits[v >> 14 & 127]) << 42;
}

// Indices of finite points in Morton order of the cells of their bounding cube, 2^21 along each axis; points of one
// cell in the order given. Fewer than 2^32 points.
std::vector<std::uint32_t> morton_order(const std::vector<Vec3d>& points);

}  // namespace pcm
