// Lossless coding of doubles as integers, for the positions of chunks that are on no grid.
#pragma once

#include "pcm/cloud/geometry.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// Each axis is coded separately in one of two ways. In both, near values have near codes.
//
// Divided, divisor > 0: the value is double(code) / divisor, where |code| <= 2^53. Decimals read from text are
// quotients of a power of ten (a decimal with n digits after the point is the double nearest to code / 10^n, and IEEE
// division gives the nearest double); values on a grid of a power of two are quotients of that power.
//
// Ordered, divisor 0: the code is the bits of the double without its sign, shifted down by `shift` bits, which are zero
// in all values; for a value whose sign bit is set it is the complement of that. It codes every double: NaN with its
// payload, infinities, -0.
struct DoubleCodes {
    Vec3d divisor{0, 0, 0};
    std::array<std::uint32_t, 3> shift{0, 0, 0};

    // From the numbers in a header; none when they are invalid.
    static std::optional<DoubleCodes> checked(const Vec3d& divisor, const Vec3d& shift);

    double to_source(std::int64_t code, std::size_t axis) const;
    bool operator==(const DoubleCodes& o) const { return divisor == o.divisor && shift == o.shift; }
};

// Chooses the coding of axis `axis` in `codes` for `count` values (> 0), and codes them.
void code_doubles(const double* values, std::size_t count, std::size_t axis, DoubleCodes& codes, std::int64_t* to);

// The inverse: to[i] is the value with the code origin + relative[i]. Word is std::uint32_t or std::uint64_t.
template <class Word>
void decode_doubles(const DoubleCodes& codes, std::size_t axis, std::int64_t origin, const Word* relative,
                    std::size_t count, double* to);

extern template void decode_doubles(const DoubleCodes&, std::size_t, std::int64_t, const std::uint32_t*, std::size_t,
                                    double*);
extern template void decode_doubles(const DoubleCodes&, std::size_t, std::int64_t, const std::uint64_t*, std::size_t,
                                    double*);

}  // namespace pcm
