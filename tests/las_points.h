// A LAS file of simple points in a few lines.
#pragma once

#include "pcm/io/las/las_writer.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <vector>

namespace pcm::test {

struct LasPoint {
    std::int32_t x = 0, y = 0, z = 0;  // on the grid
    std::uint16_t intensity = 0;
    std::uint8_t classification = 0;
    std::uint16_t source_id = 0;
    std::uint16_t red = 0, green = 0, blue = 0;
};

// With the fields of point format 2, every point return 1 of 1.
inline void write_las_points(const std::filesystem::path& path, const Grid& grid, const std::vector<LasPoint>& points)
{
    FileInfo info;
    info.grid = grid;
    info.position_type = ScalarType::i32;
    const auto add = [&](const char* name, ScalarType type, std::uint32_t components = 1) {
        info.schema.add({name, type, components, 1, 0, {}});
        return info.schema.size() - 1;
    };
    const std::size_t intensity = add("intensity", ScalarType::u16);
    const std::size_t return_number = add("return_number", ScalarType::u8);
    const std::size_t number_of_returns = add("number_of_returns", ScalarType::u8);
    add("scan_direction_flag", ScalarType::u8);
    add("edge_of_flight_line", ScalarType::u8);
    const std::size_t classification = add("classification", ScalarType::u8);
    for (const char* flag : {"synthetic", "key_point", "withheld"}) add(flag, ScalarType::u8);
    add("scan_angle_rank", ScalarType::i8);
    add("user_data", ScalarType::u8);
    const std::size_t source_id = add("point_source_id", ScalarType::u16);
    const std::size_t rgb = add("rgb", ScalarType::u16, 3);

    const auto writer = create_las(path, info);
    PointBatch batch;
    for (std::size_t done = 0; done < points.size(); done += batch.size) {
        batch.reset(info.schema, true, std::min<std::size_t>(points.size() - done, 65536));
        for (std::size_t i = 0; i < batch.size; ++i) {
            const LasPoint& point = points[done + i];
            batch.grid_xyz[0][i] = point.x;
            batch.grid_xyz[1][i] = point.y;
            batch.grid_xyz[2][i] = point.z;
            batch.attributes[intensity].as<std::uint16_t>()[i] = point.intensity;
            batch.attributes[return_number].as<std::uint8_t>()[i] = 1;
            batch.attributes[number_of_returns].as<std::uint8_t>()[i] = 1;
            batch.attributes[classification].as<std::uint8_t>()[i] = point.classification;
            batch.attributes[source_id].as<std::uint16_t>()[i] = point.source_id;
            const std::uint16_t colour[3] = {point.red, point.green, point.blue};
            std::memcpy(batch.attributes[rgb].as<std::uint16_t>() + 3 * i, colour, sizeof colour);
        }
        writer->write(batch);
    }
    writer->finish();
}

}  // namespace pcm::test
