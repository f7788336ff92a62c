// Cells of the lattice by their numbers, and the buckets of cells in which points that are near a point are looked for.
#pragma once

#include "pcm/build/levels/lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace pcm {

// Like ==, which would call memcmp.
template <class Coord>
bool same(const Point<Coord>& p, const Point<Coord>& q)
{
    return !((p[0] ^ q[0]) | (p[1] ^ q[1]) | (p[2] ^ q[2]));
}

// A place in a table of 2^bits.
template <class Coord>
std::size_t hash_of(const Point<Coord>& p, int bits)
{
    // Odd multipliers from the digits of the golden ratio's and the plastic number's powers.
    const std::uint64_t hash = static_cast<std::uint64_t>(p[0]) * 0x9E3779B97F4A7C15u +
                               static_cast<std::uint64_t>(p[1]) * 0xC2B2AE3D27D4EB4Fu +
                               static_cast<std::uint64_t>(p[2]) * 0x165667B19E3779F9u;
    return (hash ^ hash >> 29) * 0x9E3779B97F4A7C15u >> (64 - bits);
}

// c >> shift, also for shifts of 64 and more.
template <class Coord>
std::uint64_t down(Coord c, int shift)
{
    if constexpr (sizeof(Coord) == 8)
        if (shift >= 64) return 0;
    return static_cast<std::uint64_t>(c) >> std::min(shift, 63);
}

template <class Coord>
Point<Coord> cell_of(const Point<Coord>& p, const std::array<int, 3>& shifts)
{
    return {static_cast<Coord>(down(p[0], shifts[0])), static_cast<Coord>(down(p[1], shifts[1])),
            static_cast<Coord>(down(p[2], shifts[2]))};
}

// Like Lattice::shifts, but beyond 63 where cells are larger than all coordinates, so that cells group in cubes of
// equal numbers.
inline std::array<int, 3> all_shifts(const Lattice& lattice, int size)
{
    return {size + lattice.finer[0], size + lattice.finer[1], size + lattice.finer[2]};
}

// Buckets are cubes of cells, at least as wide as the spacing along every axis. Two cells are wide enough on grids that
// are equally fine along all axes.
inline int bucket_bits(const Lattice& lattice)
{
    double least = std::ldexp(lattice.scale[0], lattice.finer[0]);
    for (std::size_t a = 1; a < 3; ++a) least = std::min(least, std::ldexp(lattice.scale[a], lattice.finer[a]));
    return 2 * least > lattice.spacing(0) ? 1 : 2;
}

}  // namespace pcm
