// The grid that the positions of a new tree get.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/io/pipe/far_points.h"
#include "pcm/io/reader.h"

namespace pcm {

// What trees hold, source units: squares of distances are then normal doubles everywhere. Nothing measured comes near.
inline constexpr double largest_tree_coordinate = 0x1p500;  // 3.3e150
inline constexpr double least_tree_step = 0x1p-491;         // 1.6e-148

// The step of an axis' power-of-two grid for float sources: 2^(e-61) where every |coordinate| < 2^e, at least
// least_tree_step; offset 0. A double of the size of the largest coordinate is exact on it with 8 bits to spare; any
// coordinate is off by at most half a step.
double power_of_two_step(double largest_magnitude);

// The power-of-two grid of all points in a box.
Grid power_of_two_grid(const Box3d& box);

// Whether `grid` can stand for doubles in a box: each coordinate's grid position is distinct in double from its
// neighbours.
bool resolves(const Grid& grid, const Box3d& box);

// Throws Error(invalid_argument) when a tree cannot hold positions on this grid, of sources of integers.
void check_tree_grid(const Grid& grid);

// The same for doubles that get a power-of-two grid: when coordinates are too large, or so small that they would be
// rounded onto each other, or when some are so far from the others that these would be.
void check_tree_positions(const FarPoints& points);

}  // namespace pcm
