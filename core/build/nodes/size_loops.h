// The hot loops of point_sizes.cpp, compiled once per level of system/cpu.h. All levels give the same bits.
#pragma once

#include <cstddef>

namespace pcm {

// Points that follow one another in Morton order, in groups: 32 x, then their 32 y, then their 32 z.
inline constexpr std::size_t size_group = 32;
inline constexpr std::size_t size_neighbours = 4;

struct SizeLoops {
    // For each point of `count` groups the distance to its fourth neighbour among its group and the two next to it, or
    // to the last one found; 0 without any. Points infinitely far away do not count as neighbours.
    void (*distances)(const float* groups, std::size_t count, float* to);
    void (*distances_in_double)(const double* groups, std::size_t count, float* to);
    // The 17th, ascending, in each of `count` groups of 32 distances.
    void (*middles)(const float* distances, std::size_t count, float* to);
};

// Those of simd_level(); throws what that throws.
const SizeLoops& size_loops();

const SizeLoops& baseline_size_loops();
const SizeLoops& avx2_size_loops();
const SizeLoops& avx512_size_loops();

}  // namespace pcm
