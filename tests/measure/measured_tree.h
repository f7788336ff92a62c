// Trees of points that a test makes, for what measures clouds.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/point_cloud.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <memory>
#include <string>
#include <vector>

namespace pcm::test {

// A tree on a grid of 1 mm, of points whose coordinates are multiples of it from `origin`; the intensity is the point's
// number modulo 1000.
inline std::shared_ptr<PointCloud> measured_tree(const TemporaryFolder& folder, const std::string& name,
                                                 const std::vector<Vec3d>& points, const Vec3d& origin,
                                                 std::uint32_t chunk_points = 3000)
{
    Grid grid;
    grid.scale = {0.001, 0.001, 0.001};
    grid.offset = origin;
    std::vector<LasRecord> records;
    for (const Vec3d& p : points) {
        LasRecord record{};
        record.x = static_cast<std::int32_t>(std::llround((p[0] - origin[0]) * 1000));
        record.y = static_cast<std::int32_t>(std::llround((p[1] - origin[1]) * 1000));
        record.z = static_cast<std::int32_t>(std::llround((p[2] - origin[2]) * 1000));
        record.intensity = static_cast<std::uint16_t>(records.size() % 1000);
        records.push_back(record);
    }
    write_las(folder / (name + ".las"), records, grid);
    BuildOptions options;
    options.chunk_points = chunk_points;
    options.memory_bytes = std::uint64_t(256) << 20;
    build_tree({folder / (name + ".las")}, folder / (name + ".pct"), options);
    return PointCloud::open(folder / (name + ".pct"));
}

}  // namespace pcm::test
