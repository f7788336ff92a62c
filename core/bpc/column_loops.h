// The hot loops of column_codec.cpp, compiled once per level of system/cpu.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcm {

template <class Word>
struct ColumnLoops {
    // The smallest of `count` > 0 values; the bits that any value less that one has are added to `any`.
    Word (*reference)(const Word* values, std::size_t count, Word& any);
    // Adds the bits that the differences of consecutive values have, and those that their zigzag codes have.
    void (*differences)(const Word* values, std::size_t count, Word& any, Word& any_zigzag);
    // to[i] = (values[i] - base) >> shift
    void (*put_reference)(const Word* values, std::size_t count, Word base, int shift, Word* to);
    // to[0] = 0, to[i] = the zigzag code of (values[i] - values[i - 1]) >> shift, arithmetically
    void (*put_differences)(const Word* values, std::size_t count, int shift, Word* to);
};

struct AllColumnLoops {
    ColumnLoops<std::uint32_t> narrow;
    ColumnLoops<std::uint64_t> wide;
};

// Those of simd_level(); throws what that throws.
const AllColumnLoops& column_loops();

const AllColumnLoops& baseline_column_loops();
const AllColumnLoops& avx2_column_loops();
const AllColumnLoops& avx512_column_loops();

}  // namespace pcm
