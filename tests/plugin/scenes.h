// Small files and their trees.
#pragma once

#include "tests/las_points.h"
#include "tests/support.h"

#include "pcm/build/builder.h"
#include "pcm/generate/scene.h"
#include "plugin/scene/tree_beside.h"

#include <string>
#include <vector>

namespace pcm::host {

namespace fs = std::filesystem;

inline const Vec3d far_away{500000.0, 4800000.0, 100.0};

inline fs::path scene(const test::TemporaryFolder& folder, const std::string& name, std::uint64_t points,
                      const Vec3d& origin)
{
    SceneOptions options;
    options.points = points;
    options.origin = origin;
    options.overwrite = true;
    const fs::path las = folder / name;
    generate_scene(las, options, false);
    return las;
}

inline fs::path tree_of(const fs::path& las, std::uint32_t chunk_points = 20000)
{
    BuildOptions options;
    options.memory_bytes = std::uint64_t(64) << 20;
    options.chunk_points = chunk_points;
    options.overwrite = true;
    const fs::path tree = tree_path(las);
    build_tree({las}, tree, options);
    return tree;
}

// A file of which every point has the given colour and intensity.
inline fs::path write_las(const fs::path& path, std::size_t points, std::uint16_t red, std::uint16_t intensity_step)
{
    Grid grid;
    grid.scale = {0.01, 0.01, 0.01};
    std::vector<test::LasPoint> cloud(points);
    for (std::size_t i = 0; i < points; ++i) {
        test::LasPoint& point = cloud[i];
        point.x = static_cast<std::int32_t>(i * 7919 % 10007);
        point.y = static_cast<std::int32_t>(i * 104729 % 10009);
        point.z = static_cast<std::int32_t>(i % 101);
        point.red = red;
        point.intensity = static_cast<std::uint16_t>(i * intensity_step);
    }
    test::write_las_points(path, grid, cloud);
    return path;
}

}  // namespace pcm::host
