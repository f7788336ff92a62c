#include "pcm/cloud/attribute.h"

#include "pcm/cloud/point_batch.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm;

TEST(Schema, RefusesInvalidAttributes)
{
    Schema schema;
    schema.add({"a", ScalarType::u8, 1, 1, 0, ""});
    EXPECT_THROW(schema.add({"a", ScalarType::f32, 1, 1, 0, ""}), Error);
    EXPECT_THROW(schema.add({"", ScalarType::f32, 1, 1, 0, ""}), Error);
    EXPECT_THROW(schema.add({"b", ScalarType::f32, 0, 1, 0, ""}), Error);
    EXPECT_THROW(schema.add({"b", static_cast<ScalarType>(77), 1, 1, 0, ""}), Error);
    for (std::size_t i = schema.size(); i < max_attributes; ++i)
        schema.add({"n" + std::to_string(i), ScalarType::u8, 1, 1, 0, ""});
    EXPECT_THROW(schema.add({"one too many", ScalarType::u8, 1, 1, 0, ""}), Error);
}

TEST(Schema, PointBytes)
{
    Schema schema;
    schema.add({"rgb", ScalarType::u16, 3, 1, 0, ""});
    schema.add({"time", ScalarType::f64, 1, 1, 0, ""});
    EXPECT_EQ(schema.point_bytes(), 14u);
    EXPECT_EQ(schema.find("time"), std::optional<std::size_t>(1));
    EXPECT_FALSE(schema.find("Time"));
}

TEST(ColumnSet, Contains)
{
    Schema schema;
    for (const char* name : {"a", "b", "c"}) schema.add({name, ScalarType::u8, 1, 1, 0, ""});
    const ColumnSet all = ColumnSet::all(schema);
    const ColumnSet ab = ColumnSet::named(schema, {"a", "b", "unknown"});
    EXPECT_TRUE(all.contains(ab));
    EXPECT_FALSE(ab.contains(all));
    ColumnSet no_positions = ab;
    no_positions.positions = false;
    EXPECT_TRUE(ab.contains(no_positions));
    EXPECT_FALSE(no_positions.contains(ab));
}

TEST(Column, ValuesOfEveryType)
{
    for (int t = 1; t <= 10; ++t) {
        Column column(static_cast<ScalarType>(t), 2);
        column.resize(2);
        const auto fill = [&](auto zero) {
            using T = decltype(zero);
            column.as<T>()[3] = static_cast<T>(100);
        };
        switch (column.type()) {
            case ScalarType::i8:
                fill(std::int8_t());
                break;
            case ScalarType::u8:
                fill(std::uint8_t());
                break;
            case ScalarType::i16:
                fill(std::int16_t());
                break;
            case ScalarType::u16:
                fill(std::uint16_t());
                break;
            case ScalarType::i32:
                fill(std::int32_t());
                break;
            case ScalarType::u32:
                fill(std::uint32_t());
                break;
            case ScalarType::i64:
                fill(std::int64_t());
                break;
            case ScalarType::u64:
                fill(std::uint64_t());
                break;
            case ScalarType::f32:
                fill(float());
                break;
            case ScalarType::f64:
                fill(double());
                break;
        }
        EXPECT_EQ(column.value(1, 1), 100);
        EXPECT_EQ(column.value(0, 0), 0);
        EXPECT_EQ(column.size(), 2u);
    }
}

}  // namespace
