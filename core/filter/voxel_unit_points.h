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

// How points become those of their voxels.
struct VoxelRules {
    const VoxelGridOptions& options;
    const std::vector<Combination>& combinations;
    const Schema& from;    // schema of the points
    const Schema& schema;  // schema of the result
    bool gridded = false;  // the result is on the points' grid
};

// What all units of a tree's voxel grid share. Immutable but for `stopped`.
struct VoxelPlan {
    VoxelRules rules;
    const PointsInBoxes& cloud;
    std::size_t most_points = 0;  // in memory at once
    const std::atomic<bool>& stopped;
};

// Points in memory.
struct HeldPoints {
    Positions positions;
    std::array<std::vector<std::int32_t>, 3> grid;  // where the result is gridded
    std::vector<Column> attributes;                 // as many as the schema has

    std::size_t size() const { return positions.size(); }
};

// Memory that a point takes while it is combined with others, bytes.
std::size_t bytes_of_held_point(const Schema& schema);

struct VoxelPoints {
    PointBatch points;
    std::uint64_t points_in = 0;
    std::uint64_t most_in_one = 0;  // points of one voxel
};

// The points of all voxels that have some of `points`, in the order of group_by_voxel(), after those of `result`. Frees
// the attributes of `points` on its way.
void combine_points(const VoxelRules& rules, HeldPoints& points, VoxelPoints& result);

// One unit's result; where it has more points than memory allows it is divided further. Any thread.
VoxelPoints combine_unit(const VoxelPlan& plan, const VoxelUnit& unit);

}  // namespace pcm
