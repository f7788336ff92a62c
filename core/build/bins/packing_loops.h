// The hot loops of row_packing.cpp, compiled once per level of system/cpu.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcm {

struct PackingLoops {
    // The bits in which any of the values differs from `first`.
    std::uint64_t (*differing)(const std::uint64_t* values, std::size_t count, std::uint64_t first);
    // The smallest value of a field, of values whose sign bits are flipped by `sign`.
    std::uint64_t (*least)(const std::uint64_t* values, std::size_t count, std::uint64_t sign, int shift,
                           std::uint64_t mask);
    // Makes each value (value ^ sign) - base, and returns the bits that any of them has.
    std::uint64_t (*subtract)(std::uint64_t* values, std::size_t count, std::uint64_t sign, std::uint64_t base);
    // Adds (value >> from & mask) << place to each of `to`.
    void (*move_bits)(const std::uint64_t* values, std::size_t count, int from, std::uint64_t mask, int place,
                      std::uint64_t* to);
    // Makes each value (value + base) ^ sign.
    void (*add)(std::uint64_t* values, std::size_t count, std::uint64_t base, std::uint64_t sign);
};

// Those of simd_level(); throws what that throws.
const PackingLoops& packing_loops();

const PackingLoops& baseline_packing_loops();
const PackingLoops& avx2_packing_loops();
const PackingLoops& avx512_packing_loops();

}  // namespace pcm
