// Points of arrays as plain rows, and arrays of numbered points.
#pragma once

#include "pcm/bpc/bpc_array.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <random>

namespace pcm::test {

struct Row {
    Vec3d position{0, 0, 0};
    std::uint16_t intensity = 0;
    std::array<float, 3> normal{0, 0, 0};
    double time = 0;
    bool operator==(const Row& o) const
    {
        return std::memcmp(position.data(), o.position.data(), sizeof position) == 0 && intensity == o.intensity &&
               std::memcmp(normal.data(), o.normal.data(), sizeof normal) == 0 &&
               std::memcmp(&time, &o.time, sizeof time) == 0;
    }
};

inline BpcCloud cloud_of_rows(bool gridded)
{
    BpcCloud cloud;
    cloud.schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    cloud.schema.add({"normal", ScalarType::f32, 3, 1, 0, "unit length"});
    cloud.schema.add({"gps_time", ScalarType::f64, 1, 1, 0, ""});
    cloud.metadata = {{"key", {std::byte{1}}}};
    if (gridded) {
        cloud.grid = Grid{{0.5, 0.25, 0.125}, {1000, 0, -3}};
        cloud.position_type = ScalarType::i32;
    }
    return cloud;
}

// Coordinates on the grid above; without a grid also NaN and -0.
inline Row random_row(std::mt19937_64& random, bool gridded)
{
    Row row;
    const Grid grid = *cloud_of_rows(true).grid;
    for (std::size_t a = 0; a < 3; ++a) {
        row.position[a] = grid.to_source(static_cast<std::int32_t>(random()) >> (random() % 30), a);
        if (!gridded && random() % 4 == 0)
            row.position[a] = random() % 2 ? -0.0 : std::numeric_limits<double>::quiet_NaN();
    }
    row.intensity = static_cast<std::uint16_t>(random());
    for (float& n : row.normal) n = static_cast<float>(random() % 1000) / 1000;
    row.time = static_cast<double>(random() % 1000000) / 1e3;
    return row;
}

struct Columns {
    explicit Columns(const BpcArray& array)
        : intensity(array.column<std::uint16_t>("intensity")),
          normal(array.column<float>("normal")),
          time(array.column<double>("gps_time"))
    {
    }
    BpcColumnOf<std::uint16_t> intensity;
    BpcColumnOf<float> normal;
    BpcColumnOf<double> time;
};

inline void put(BpcArray& array, std::uint64_t i, const Row& row, const Columns& columns)
{
    const auto point = array[i];
    point.set_position(row.position);
    point.set(columns.intensity, row.intensity);
    for (std::uint32_t c = 0; c < 3; ++c) point.set(columns.normal, row.normal[c], c);
    point.set(columns.time, row.time);
}

inline Row get(BpcArray& array, std::uint64_t i, const Columns& columns)
{
    Row row;
    const auto point = array[i];
    row.position = point.position();
    row.intensity = point.get(columns.intensity);
    for (std::uint32_t c = 0; c < 3; ++c) row.normal[c] = point.get(columns.normal, c);
    row.time = point.get(columns.time);
    return row;
}

// A cloud of `points` numbered points in chunks of `chunk_points`; intensity and time are the number.
inline void write_numbered(const std::filesystem::path& path, std::size_t points, std::size_t chunk_points,
                           bool gridded = true)
{
    BpcArrayOptions options;
    options.chunk_points = chunk_points;
    BpcArray array(path, cloud_of_rows(gridded), options);
    const Columns columns(array);
    for (std::size_t i = 0; i < points; ++i) {
        const auto point = array.push_back();
        point.set_position({1000 + static_cast<double>(i), 0.25, -3});
        point.set(columns.intensity, static_cast<std::uint16_t>(i));
        point.set(columns.time, static_cast<double>(i));
    }
    array.flush();
}

inline std::size_t files_in(const std::filesystem::path& folder)
{
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace pcm::test
