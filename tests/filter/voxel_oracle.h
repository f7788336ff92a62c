// The voxel grid of a cloud in memory, by a map of its voxels: slow, simple, in long double.
#pragma once

#include "pcm/filter/voxel_lattice.h"

#include "tests/memory_reader.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace pcm::test {

using Voxel = std::array<std::int64_t, 3>;

inline Voxel voxel_of(const VoxelLattice& lattice, const Vec3d& p)
{
    Voxel voxel;
    for (std::size_t a = 0; a < 3; ++a)
        voxel[a] = static_cast<std::int64_t>(std::floor((p[a] - lattice.anchor[a]) / lattice.size));
    return voxel;
}

// The numbers of the points in each voxel.
inline std::map<Voxel, std::vector<std::size_t>> voxels_of(const MemoryCloud& cloud, const VoxelLattice& lattice)
{
    std::map<Voxel, std::vector<std::size_t>> voxels;
    for (std::size_t i = 0; i < cloud.points.size; ++i)
        voxels[voxel_of(lattice, position_of(cloud.points, cloud.info.grid, i))].push_back(i);
    return voxels;
}

inline long double mean_position(const MemoryCloud& cloud, const std::vector<std::size_t>& points, std::size_t axis)
{
    long double sum = 0;
    const double first = position_of(cloud.points, cloud.info.grid, points[0])[axis];
    for (const std::size_t i : points)
        sum += static_cast<long double>(position_of(cloud.points, cloud.info.grid, i)[axis]) - first;
    return first + sum / static_cast<long double>(points.size());
}

}  // namespace pcm::test
