// Points in memory, grouped by voxel: the kernel of the voxel grid.
#pragma once

#include "pcm/filter/column_groups.h"
#include "pcm/filter/voxel_lattice.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

using Positions = std::vector<Vec3d>;  // source units, finite

// Scratch memory, to be used again.
struct VoxelSort {
    std::vector<std::uint64_t> keys, other;
    std::vector<std::size_t> places;
};

// Groups at most 2^32 - 1 points by voxel, in ascending order of the voxels' z, y and x; the points of a group in their
// own order. By a radix sort of numbers of the voxels within the points' box; where that box has more voxels than such
// numbers hold, by comparisons.
void group_by_voxel(const Positions& points, const VoxelLattice& lattice, VoxelSort& scratch, PointGroups& groups);

// The centroid of each group: of each axis the mean offset from the group's first point, summed with compensation, plus
// that point's coordinate. So it is off by about half a last bit of the coordinate, however many points and however
// far from 0, and it lies between the points: the first of them keeps the mean further from the others' coordinates
// than rounding could bring it back.
Positions centroids(const Positions& points, const PointGroups& groups);

// For each group the point nearest to its centroid, the first of several.
std::vector<std::uint32_t> nearest_to(const Positions& centroids, const Positions& points, const PointGroups& groups);

}  // namespace pcm
