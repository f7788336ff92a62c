// A cloud's voxels, divided into boxes of them that hold about as many points as fit in memory.
#pragma once

#include "pcm/filter/points_in_boxes.h"
#include "pcm/filter/voxel_lattice.h"

#include <cstdint>
#include <vector>

namespace pcm {

// Numbers of voxels, both ends included.
struct VoxelUnit {
    Box3i voxels;
    bool is_one() const { return voxels.min == voxels.max; }
};

// Boxes that share no voxel and cover all points of the tree, in an order in which neighbours mostly follow each other.
// Each has an estimated number of points of at most `points`, unless it is a single voxel. Only the tree and the
// lattice decide.
std::vector<VoxelUnit> divide_into_units(const PointsInBoxes& cloud, const VoxelLattice& lattice, double points);

// The grid positions of the tree whose voxels are in a unit; empty when there are none.
Box3i grid_box_of(const PointsInBoxes& cloud, const VoxelLattice& lattice, const VoxelUnit& unit);

// Divides a unit in two, between voxels, so that the points given are divided evenly, or where they are all in one
// voxel, so that this voxel comes nearer to having a unit of its own. The unit has more than one voxel.
std::pair<VoxelUnit, VoxelUnit> divide_unit(const VoxelUnit& unit, const VoxelLattice& lattice,
                                            const std::array<std::vector<double>, 3>& points);

}  // namespace pcm
