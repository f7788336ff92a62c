// Points kept of a batch, byte by byte, for columns of every width.
#include "pcm/cloud/point_batch.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace pcm {
namespace {

std::string bytes_of(const Column& column, std::size_t point)
{
    return {reinterpret_cast<const char*>(column.data()) + point * column.point_bytes(), column.point_bytes()};
}

TEST(PointBatch, IsResetToAnySchemaWhateverItWas)
{
    std::mt19937_64 random(2);
    PointBatch batch;
    for (int round = 0; round < 50; ++round) {
        Schema schema;
        for (std::size_t n = random() % 5; n > 0; --n)
            schema.add({"a" + std::to_string(n),
                        random() % 2 ? ScalarType::u8 : ScalarType::f64,
                        static_cast<std::uint32_t>(1 + random() % 3),
                        1,
                        0,
                        {}});
        const bool gridded = random() % 2;
        const std::size_t points = random() % 100;
        batch.reset(schema, gridded, points);
        EXPECT_EQ(batch.size, points);
        EXPECT_EQ(batch.gridded, gridded);
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_EQ(batch.grid_xyz[a].size(), gridded ? points : 0);
            EXPECT_EQ(batch.xyz[a].size(), gridded ? 0 : points);
        }
        ASSERT_EQ(batch.attributes.size(), schema.size());
        for (std::size_t k = 0; k < schema.size(); ++k) {
            EXPECT_EQ(batch.attributes[k].type(), schema[k].type);
            EXPECT_EQ(batch.attributes[k].components(), schema[k].components);
            EXPECT_EQ(batch.attributes[k].size(), points);
        }
    }
}

TEST(PointBatch, KeepsTheGivenPointsAndNoOthers)
{
    std::mt19937_64 random(1);
    Schema schema;
    for (const ScalarType type : {ScalarType::u8, ScalarType::i16, ScalarType::f32, ScalarType::u64})
        for (std::uint32_t components = 1; components <= 4; ++components) {
            Attribute attribute;
            attribute.name = "a" + std::to_string(schema.size());
            attribute.type = type;
            attribute.components = components;
            schema.add(attribute);
        }
    for (int round = 0; round < 60; ++round) {
        const bool gridded = round % 2;
        const std::size_t points = random() % 300;
        PointBatch batch;
        batch.reset(schema, gridded, points);
        for (std::size_t i = 0; i < points; ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                if (gridded)
                    batch.grid_xyz[a][i] = static_cast<std::int32_t>(random());
                else
                    batch.xyz[a][i] = static_cast<double>(random());
            }
        for (Column& column : batch.attributes)
            for (std::size_t b = 0; b < column.bytes(); ++b) column.data()[b] = static_cast<std::byte>(random());
        const PointBatch before = batch;
        std::vector<std::uint32_t> kept;  // all, some or none
        for (std::uint32_t i = 0; i < points; ++i)
            if (round % 5 == 0 || (round % 5 > 1 && random() % 3)) kept.push_back(i);
        keep_points(batch, kept);
        ASSERT_EQ(batch.size, kept.size());
        for (std::size_t i = 0; i < kept.size(); ++i) {
            for (std::size_t a = 0; a < 3; ++a) {
                if (gridded)
                    ASSERT_EQ(batch.grid_xyz[a][i], before.grid_xyz[a][kept[i]]);
                else
                    ASSERT_EQ(batch.xyz[a][i], before.xyz[a][kept[i]]);
            }
            for (std::size_t k = 0; k < schema.size(); ++k)
                ASSERT_EQ(bytes_of(batch.attributes[k], i), bytes_of(before.attributes[k], kept[i])) << k << ", " << i;
        }
        for (const Column& column : batch.attributes) ASSERT_EQ(column.size(), kept.size());
    }
}

}  // namespace
}  // namespace pcm
