// Voxels: equal cubes that fill space, numbered along each axis.
#pragma once

#include "pcm/cloud/geometry.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace pcm {

// A point belongs to the voxel floor((x - anchor) / size), evaluated per axis in double; a point on a border belongs to
// the voxel above it. The numbers are exact while they are below 2^52 in magnitude (check_voxels()).
struct VoxelLattice {
    double size = 1;  // edge, source units
    Vec3d anchor{0, 0, 0};

    double number(double x, std::size_t axis) const { return std::floor((x - anchor[axis]) / size); }
    std::int64_t index(double x, std::size_t axis) const { return static_cast<std::int64_t>(number(x, axis)); }
};

// Throws Error(invalid_argument) for a size that is not a positive number, an anchor that is not finite, voxels smaller
// than the steps of `grid`, on which the positions are, and voxels too small to be distinguished
// by doubles in `box`. `grid` is null for positions that are doubles.
void check_voxels(const VoxelLattice& lattice, const Box3d& box, const Grid* grid);

}  // namespace pcm
