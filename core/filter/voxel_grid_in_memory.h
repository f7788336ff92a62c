// The voxel grid of points that fit in memory: read once and combined at once, without a tree in between.
#pragma once

#include "pcm/filter/voxel_grid.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

// Whether the points of a file that says how many it has are combined in half of this memory.
bool fits_in_memory(const FileInfo& points, std::uint64_t memory_bytes);

// As voxel_grid() of a tree; the points of the result are in the order of their voxels' z, y and x. Points without a
// finite position are left out and counted. `names` are those that a tree names as its sources. `result.target` is a
// copy. Throws what check_voxels(), combinations_of(), the reader, and build_or_write() throw.
VoxelGridReport voxel_grid_in_memory(PointReader& points, const std::vector<std::string>& names,
                                     const VoxelGridOptions& options, const ResultOptions& result);

}  // namespace pcm
