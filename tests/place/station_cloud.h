// Clouds of several stations, which say in different ways from which one a point is.
#pragma once

#include "tests/place/shape_cloud.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

namespace pcm::test {

inline constexpr double scan_noise = 0.0015;
inline constexpr Vec3d hall{454321, 5412345, 310};

struct StationPoint {
    Vec3d position{};
    int station = 0;
};

enum class Says { nothing, source_id, one_source_id, other_ids, tiles, time };

// The number of a tile, as a file of a large project has it.
inline std::uint16_t tile_of(const Vec3d& p)
{
    const auto along = [&](std::size_t k) { return static_cast<int>(std::floor((p[k] - hall[k]) / 2)) + 10; };
    return static_cast<std::uint16_t>(100 * along(0) + along(1));
}

inline void write_stations_ply(const std::filesystem::path& path, const std::vector<StationPoint>& points, Says says)
{
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size() << "\n";
    for (const char* axis : {"x", "y", "z"}) file << "property double " << axis << "\n";
    const bool has_ids =
        says == Says::source_id || says == Says::one_source_id || says == Says::other_ids || says == Says::tiles;
    if (has_ids) file << "property ushort point_source_id\n";
    if (says == Says::time) file << "property double gps_time\n";
    file << "end_header\n";
    for (std::size_t i = 0; i < points.size(); ++i) {
        file.write(reinterpret_cast<const char*>(points[i].position.data()), 24);
        const auto id = static_cast<std::uint16_t>(says == Says::source_id   ? 11 + points[i].station
                                                   : says == Says::other_ids ? 7 * i
                                                   : says == Says::tiles     ? tile_of(points[i].position)
                                                                             : 7);
        // A scan takes two minutes, and the scanner one to its next station.
        const double time =
            1e8 + 180.0 * points[i].station + 120.0 * static_cast<double>(i) / static_cast<double>(points.size());
        if (has_ids) file.write(reinterpret_cast<const char*>(&id), 2);
        if (says == Says::time) file.write(reinterpret_cast<const char*>(&time), 8);
    }
}

inline std::shared_ptr<const Tree> build_station_tree(const std::filesystem::path& folder,
                                                      const std::vector<StationPoint>& points, Says says,
                                                      std::uint32_t chunk_points = 4000)
{
    write_stations_ply(folder / "stations.ply", points, says);
    return build_tree_of_ply(folder, "stations", chunk_points);
}

}  // namespace pcm::test
