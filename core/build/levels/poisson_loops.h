// The hot loops of poisson_pass.cpp, compiled once per level of system/cpu.h. What they find does not depend on the
// level.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcm {

// Error bound of squared distances in float, in spacings: coordinates are below 36 cells (a block of 32, and a bucket
// of at most 4 more), each less than 0.9 wide, so their errors are below 2e-6, and the errors of differences below
// 4e-6; there are three differences, at most about 1 where it matters.
inline constexpr float distance_error = 5e-5f;
inline constexpr float surely_inside = 1 - distance_error, surely_outside = 1 + distance_error;

inline constexpr std::size_t near_padding = 16;  // chosen points are padded, far away, to a multiple of this

// Points of a block of cells, in Morton order. Coordinates in spacings from the block's corner.
struct PlacedPoints {
    static constexpr std::size_t most = 1024;
    float x[most], y[most], z[most];
    std::uint16_t cell[most];  // number of the cell in its block
};

// Chosen points, padded; in the same units.
struct ChosenNear {
    const float *x, *y, *z;
    std::size_t count;
};

struct OpenPoint {
    std::size_t index;
    bool is_sure;  // float shows that every chosen point is at least the spacing away
};

struct PoissonLoops {
    // The first of the points [i, end) whose cell is not `taken` (one bit per cell) and that is in another bucket, or
    // has none of `near` inside the spacing, as far as float shows; `end` if there is no such point. `mask`: from a
    // cell's number to its bucket.
    OpenPoint (*first_open)(const PlacedPoints& points, std::size_t i, std::size_t end, const std::uint64_t* taken,
                            std::size_t bucket, std::size_t mask, const ChosenNear& near);
};

// Those of simd_level(); throws what that throws.
const PoissonLoops& poisson_loops();

const PoissonLoops& baseline_poisson_loops();
const PoissonLoops& avx2_poisson_loops();
const PoissonLoops& avx512_poisson_loops();

}  // namespace pcm
