// The size of a point: about how far it is from its neighbours on the surface, so that splats of that radius leave no
// holes. Chunks of trees keep it in a byte per point, on a scale of quarter octaves.
#pragma once

#include "pcm/cloud/geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pcm {

// No size is known: 0.
inline constexpr std::uint8_t unknown_size = 0;
inline constexpr int sizes_per_octave = 4;

// What code 1 stands for, source units: half of the diagonal of the grid's cell.
inline double least_point_size(const Grid& grid)
{
    return 0.5 * std::hypot(grid.scale[0], grid.scale[1], grid.scale[2]);
}

// The size that a code from 1 on stands for, source units.
inline double point_size(std::uint8_t code, double least)
{
    return least * std::exp2((code - 1) / double{sizes_per_octave});
}

// The code of the smallest size that is not below `size`; from 1 on.
inline std::uint8_t size_code(double size, double least)
{
    if (!(size > least)) return 1;
    return static_cast<std::uint8_t>(std::min(255.0, 1 + std::ceil(sizes_per_octave * std::log2(size / least) - 1e-9)));
}

}  // namespace pcm
