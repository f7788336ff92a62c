// Where the guesses about columns change their mind, at both sides of each threshold.
#include "pcm/io/text/text_columns.h"

#include "tests/io/text/read_text.h"

namespace pcm::test {
namespace {

std::string guessed(const std::vector<ColumnLook>& looks, std::uint64_t rows)
{
    std::string text;
    for (const TextColumn& column : guess_columns(looks, rows)) text += (text.empty() ? "" : " ") + column.name;
    return text;
}

ColumnLook numbers(double least, double most, bool whole = true)
{
    ColumnLook look;
    look.values = 1000;
    look.least = least;
    look.most = most;
    look.whole = look.digits_only = whole;
    return look;
}

TEST(TextColumns, NormalsMayHaveFewExceptionsAndManyZeros)
{
    const auto with = [](std::uint64_t units, std::uint64_t zeros) {
        std::vector<ColumnLook> looks(6, numbers(-1, 1, false));
        looks[3].unit_vectors = units;
        looks[3].null_vectors = zeros;
        return guessed(looks, 1000);
    };
    const std::string normals = "x y z nx ny nz", others = "x y z column_4 column_5 column_6";
    EXPECT_EQ(with(1000, 0), normals);
    EXPECT_EQ(with(980, 0), normals);  // 20 of 1000 are of another length
    EXPECT_EQ(with(979, 0), others);
    EXPECT_EQ(with(500, 500), normals);  // half of them have none
    EXPECT_EQ(with(499, 501), others);
    EXPECT_EQ(with(480, 500), others);
    EXPECT_EQ(with(500, 480), normals);
}

TEST(TextColumns, ColoursAreWithinTheirRange)
{
    const auto with = [](double most, bool whole, std::size_t columns) {
        return guessed(std::vector<ColumnLook>(columns, numbers(0, most, whole)), 1000);
    };
    EXPECT_EQ(with(255, true, 6), "x y z r g b");
    EXPECT_EQ(with(65535, true, 6), "x y z r g b");
    EXPECT_EQ(with(65536, true, 6), "x y z column_4 column_5 column_6");
    EXPECT_EQ(with(1, false, 6), "x y z r g b");
    EXPECT_EQ(with(1.001, false, 6), "x y z column_4 column_5 column_6");
    // Among many columns only small whole numbers are colours; the first of four is the intensity.
    EXPECT_EQ(with(256, true, 7), "x y z intensity r g b");
    EXPECT_EQ(with(256, true, 8), "x y z column_4 column_5 column_6 column_7 column_8");
    EXPECT_EQ(with(255, true, 8), "x y z r g b column_7 column_8");
}

TEST(TextColumns, FloatsAsPrintedHaveEightDigits)
{
    const auto type_with = [](std::size_t digits, bool single, bool whole) {
        std::vector<ColumnLook> looks(4, numbers(0, 1e6, whole));
        looks[3].digits = digits;
        looks[3].single = single;
        return plan_columns({{"x"}, {"y"}, {"z"}, {"a"}}, looks, std::nullopt, false).schema[0].type;
    };
    EXPECT_EQ(type_with(8, true, false), ScalarType::f32);
    EXPECT_EQ(type_with(7, true, false), ScalarType::f64);  // may be so by accident
    EXPECT_EQ(type_with(9, false, false), ScalarType::f64);
    EXPECT_EQ(type_with(9, true, true), ScalarType::f64);
}

TEST(TextColumns, AttributesOfLasHaveItsTypesWhereTheyFit)
{
    const auto type_of = [](const char* name, double least, double most, bool signed_intensity = false) {
        std::vector<ColumnLook> looks(4, numbers(least, most));
        return plan_columns({{"x"}, {"y"}, {"z"}, {name}}, looks, std::nullopt, signed_intensity).schema[0].type;
    };
    EXPECT_EQ(type_of("classification", 0, 255), ScalarType::u8);
    EXPECT_EQ(type_of("classification", 0, 256), ScalarType::f64);
    EXPECT_EQ(type_of("classification", -1, 255), ScalarType::f64);
    EXPECT_EQ(type_of("scan_angle_rank", -128, 127), ScalarType::i8);
    EXPECT_EQ(type_of("scan_angle_rank", -129, 127), ScalarType::f64);
    EXPECT_EQ(type_of("scan_angle_rank", -128, 128), ScalarType::f64);
    EXPECT_EQ(type_of("intensity", 0, 65535), ScalarType::u16);
    EXPECT_EQ(type_of("intensity", 0, 65535, true), ScalarType::u16);
    EXPECT_EQ(type_of("intensity", 0, 32767, true), ScalarType::i16);
    EXPECT_EQ(type_of("intensity", -32768, 32767), ScalarType::i16);
    EXPECT_EQ(type_of("intensity", -32769, 32767), ScalarType::f64);
    EXPECT_EQ(type_of("intensity", 0, 65536), ScalarType::f64);
}

TEST(TextColumns, UnitVectorsAreMeasured)
{
    // Normals are printed with three decimals at least: a length may be off by a rounding, not by more.
    const auto names = [](const char* normal) {
        std::string text;
        for (int i = 0; i < 10; ++i) text += std::string("1 2 3 ") + normal + "\n";
        return names_of(read_text(text).info.schema);
    };
    EXPECT_EQ(names("0.577 0.577 0.578"), "normal:f32x3");
    EXPECT_EQ(names("0 0 0.9981"), "normal:f32x3");
    EXPECT_NE(names("0 0 0.9979"), "normal:f32x3");
    EXPECT_NE(names("0 0 1.0021"), "normal:f32x3");
}

}  // namespace
}  // namespace pcm::test
