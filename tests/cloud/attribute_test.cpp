#include "pcm/cloud/attribute.h"

#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/system/text.h"
#include "tests/support.h"

#include <fstream>

namespace {

using namespace pcm;

TEST(Schema, RefusesWhatMakesNoSense)
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

TEST(Box, EmptyExtendContains)
{
    Box3d box;
    EXPECT_TRUE(box.empty());
    EXPECT_EQ(box.diagonal(), 0);
    box.extend(Vec3d{1, 2, 3});
    EXPECT_FALSE(box.empty());
    EXPECT_TRUE(box.contains(Vec3d{1, 2, 3}));
    box.extend(Vec3d{5e6, 2, 3});
    EXPECT_TRUE(box.contains(Vec3d{5e6, 2, 3}));
    EXPECT_FALSE(box.contains(Vec3d{5e6, 2.5, 3}));
    EXPECT_FALSE(Box3d().intersects(box));
    EXPECT_FALSE(box.contains(Box3d()));
}

TEST(Text, NumbersForPeople)
{
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1234567), "1,234,567");
    EXPECT_EQ(exact(500000), "500000");
    EXPECT_EQ(exact(848935.2000000001), "848935.2000000001");
    EXPECT_EQ(exact(1e-9), "1e-09");
    EXPECT_EQ(bytes_text(999), "999 bytes");
    EXPECT_EQ(bytes_text(1250000000), "1.25 GB");
    for (const double value : {0.1, 1e300, -4.8e6, 2323.0000000000005}) EXPECT_EQ(std::stod(exact(value)), value);
}

TEST(File, ErrorsNameThePath)
{
    const test::TemporaryFolder folder;
    try {
        File(folder / "nothing", File::Mode::read);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::not_found);
        EXPECT_NE(std::string(error.what()).find("nothing"), std::string::npos);
    }
    std::ofstream(folder / "short") << "12345";
    const File file(folder / "short", File::Mode::read);
    char buffer[10];
    EXPECT_EQ(file.read_some_at(buffer, 10, 2), 3u);
    try {
        file.read_at(buffer, 10, 2);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::truncated);
        EXPECT_NE(std::string(error.what()).find("ends at byte 5"), std::string::npos) << error.what();
    }
    EXPECT_THROW(File(folder / "short", File::Mode::create_new), Error);
}

TEST(File, ReplaceByABareName)
{
    const test::TemporaryFolder folder;
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    replace_file("f", "text", 4);
    std::filesystem::current_path(before);
    EXPECT_EQ(std::filesystem::file_size(folder / "f"), 4u);
}

TEST(File, ReplaceLeavesTheOldOneWhenItFails)
{
    const test::TemporaryFolder folder;
    replace_file(folder / "f", "old", 3);
    std::filesystem::create_directory(folder / "f.new");  // in the way of the temporary file
    EXPECT_THROW(replace_file(folder / "f", "newer", 5), Error);
    std::ifstream file(folder / "f");
    std::string text;
    file >> text;
    EXPECT_EQ(text, "old");
}

}  // namespace
