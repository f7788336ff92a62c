// The voxels of one unit as points.
#pragma once

#include "pcm/cloud/point_batch.h"
#include "pcm/filter/combined_attributes.h"
#include "pcm/filter/voxel_grid.h"
#include "pcm/filter/voxel_groups.h"
#include "pcm/filter/voxel_units.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// What all units of a voxel grid share. Immutable but for `stopped`.
struct VoxelPlan {
    const PointsInBoxes& cloud;
    const VoxelGridOptions& options;
    const std::vector<Combination>& combinations;
    const Schema& schema;         // schema of the result
    bool gridded = false;         // the result is on the tree's grid
    std::size_t most_points = 0;  // in memory at once
    const std::atomic<bool>& stopped;
};

struct VoxelPoints {
    PointBatch points;
    std::uint64_t points_in = 0;
    std::uint64_t most_in_one = 0;  // points of one voxel
};

// One unit's result; where it has more points than memory allows it is divided further. Any thread.
VoxelPoints combine_unit(const VoxelPlan& plan, const VoxelUnit& unit);

}  // namespace pcm
