// Gridded clouds for the tests of the LAS writer.
#pragma once

#include "tests/io/cloud_copy.h"
#include "tests/io/las_file.h"

#include <random>
#include <utility>
#include <vector>

namespace pcm::test {

inline const Grid grid{{0.001, 0.002, 0.5}, {5e6, -3e6, 100}};

inline Whole gridded_cloud(Schema schema, std::size_t points, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    Whole cloud;
    cloud.info.schema = std::move(schema);
    cloud.info.grid = grid;
    cloud.info.position_type = ScalarType::i32;
    cloud.points.reset(cloud.info.schema, true, points);
    randomize(cloud.points, random);
    return cloud;
}

inline Schema schema_of(const std::vector<Attribute>& attributes)
{
    Schema schema;
    for (const Attribute& attribute : attributes) schema.add(attribute);
    return schema;
}

// Positions without a grid, numbered by "id".
inline Whole doubles(const std::vector<Vec3d>& positions)
{
    Whole cloud;
    cloud.info.schema.add({"id", ScalarType::u32, 1, 1, 0, {}});
    cloud.points.reset(cloud.info.schema, false, positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = positions[i][a];
        cloud.points.attributes[0].as<std::uint32_t>()[i] = static_cast<std::uint32_t>(i);
    }
    return cloud;
}

}  // namespace pcm::test
