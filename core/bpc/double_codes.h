// Doubles as integers and back, bit for bit: how a chunk keeps positions that lie on no grid.
#pragma once

#include "pcm/cloud/geometry.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// Each axis for itself is coded in one of two ways, so that codes of near values are near.
//
// Divided, divisor > 0: the value is double(code) / divisor, where |code| <= 2^53. Decimals that were read from text
// are such quotients of a power of ten (a decimal of n digits after the point is the double nearest to code / 10^n, and
// IEEE division gives the nearest), and what lies on a grid of a power of two is a quotient of it.
//
// Ordered, divisor 0: the code is the bits of the double without its sign, less `shift` low bits, which are zero in all
// values, and its complement for a value whose sign is set. It holds everything: NaN with its payload, infinities, -0.
struct DoubleCodes {
    Vec3d divisor{0, 0, 0};
    std::array<std::uint32_t, 3> shift{0, 0, 0};

    // The same from a header's numbers; none when they make no sense.
    static std::optional<DoubleCodes> checked(const Vec3d& divisor, const Vec3d& shift);

    double to_source(std::int64_t code, std::size_t axis) const;
    bool operator==(const DoubleCodes& o) const { return divisor == o.divisor && shift == o.shift; }
};

// Chooses the coding of `count` values (> 0) for axis `axis` of `codes` and codes them.
void code_doubles(const double* values, std::size_t count, std::size_t axis, DoubleCodes& codes, std::int64_t* to);

// The reverse: to[i] is the value whose code is origin + relative[i]. Word is std::uint32_t or std::uint64_t.
template <class Word>
void decode_doubles(const DoubleCodes& codes, std::size_t axis, std::int64_t origin, const Word* relative,
                    std::size_t count, double* to);

extern template void decode_doubles(const DoubleCodes&, std::size_t, std::int64_t, const std::uint32_t*, std::size_t,
                                    double*);
extern template void decode_doubles(const DoubleCodes&, std::size_t, std::int64_t, const std::uint64_t*, std::size_t,
                                    double*);

}  // namespace pcm
