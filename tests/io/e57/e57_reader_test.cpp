#include "pcm/io/e57/e57_reader.h"

#include "pcm/io/e57/e57_pages.h"
#include "pcm/system/file.h"
#include "tests/io/e57/e57_test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace pcm::test {
namespace {

using Field = E57TestField;

TEST_F(E57, ChecksumsAreThoseOfTheStandard)
{
    std::mt19937_64 random(1);
    for (std::size_t size : {0, 1, 7, 8, 9, 63, 1020}) {
        std::string bytes;
        for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(random());
        EXPECT_EQ(crc32c(reinterpret_cast<const std::byte*>(bytes.data()), size), slow_crc32c(bytes));
    }
    const std::string check = "123456789";  // the published check value of CRC-32C
    EXPECT_EQ(crc32c(reinterpret_cast<const std::byte*>(check.data()), 9), 0xE3069283u);
}

// Integers of every width, in packets with unbalanced streams.
TEST_F(E57, IntegersOfEveryWidth)
{
    constexpr std::size_t count = 5000;
    std::mt19937_64 random(2);
    std::vector<Field> fields;
    std::vector<std::vector<std::int64_t>> expected;
    for (unsigned bits = 0; bits <= 64; bits += bits < 20 ? 1 : 4) {
        const std::uint64_t span = bits == 0 ? 0 : bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
        const std::int64_t min = bits == 64   ? std::numeric_limits<std::int64_t>::min()
                                 : bits == 60 ? -(std::int64_t{1} << 59)
                                              : -static_cast<std::int64_t>(random() % 300);
        std::vector<std::int64_t> values;
        for (std::size_t i = 0; i < count; ++i)
            values.push_back(static_cast<std::int64_t>(static_cast<std::uint64_t>(min) + (random() & span)));
        fields.push_back(Field::integer("las:f" + std::to_string(bits), min,
                                        static_cast<std::int64_t>(static_cast<std::uint64_t>(min) + span), values));
        expected.push_back(values);
    }
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
        const Whole whole = read({simple_scan(count, fields)}, seed);
        ASSERT_EQ(whole.points.size, count);
        ASSERT_EQ(whole.info.schema.size(), fields.size());
        for (std::size_t f = 0; f < fields.size(); ++f) {
            const Column& column = whole.points.attributes[f];
            for (std::size_t i = 0; i < count; ++i) {
                std::int64_t value = 0;
                if (column.type() == ScalarType::i64)
                    value = column.as<std::int64_t>()[i];
                else
                    value = static_cast<std::int64_t>(column.value(i));
                ASSERT_EQ(value, expected[f][i]) << whole.info.schema[f].name << " " << name_of(column.type());
            }
        }
        for (std::size_t i = 0; i < count; ++i)
            ASSERT_EQ(whole.position(i), (Vec3d{double(i), 100 + double(i), -1 - double(i)}));
    }
}

TEST_F(E57, FloatsAndScaledIntegersAreExact)
{
    std::mt19937_64 random(3);
    std::vector<float> singles;
    std::vector<double> doubles;
    std::vector<std::int64_t> integers;
    for (std::size_t i = 0; i < 3000; ++i) {
        const auto bits = static_cast<std::uint32_t>(random());
        float value;
        std::memcpy(&value, &bits, 4);
        singles.push_back(std::isnan(value) ? -0.f : value);
        doubles.push_back(std::ldexp(static_cast<double>(random()), static_cast<int>(random() % 200) - 100));
        integers.push_back(static_cast<std::int64_t>(random() % 4000000) - 1000000);
    }
    E57TestScan scan;
    const std::string scaling = "scale=\"0.001\" offset=\"5000000\"";
    scan.fields = {Field::integer("cartesianX", -1000000, 3000000, integers, scaling),
                   Field::f64("cartesianY", doubles),
                   Field::f32("cartesianZ", singles),
                   Field::f32("intensity", singles),
                   Field::f64("timeStamp", doubles),
                   Field::integer("las:scanAngle", -1000000, 3000000, integers, scaling)};
    const Whole whole = read({scan});
    EXPECT_EQ(whole.info.position_type, ScalarType::f64);
    const Attribute& angle = whole.info.schema[*whole.info.schema.find("scan_angle")];
    EXPECT_EQ(angle.scale, 0.001);
    EXPECT_EQ(angle.offset, 5000000);
    EXPECT_EQ(angle.type, ScalarType::i32);
    for (std::size_t i = 0; i < singles.size(); ++i) {
        ASSERT_EQ(whole.position(i)[0], static_cast<double>(integers[i]) * 0.001 + 5000000);
        ASSERT_EQ(whole.position(i)[1], doubles[i]);
        ASSERT_EQ(whole.position(i)[2], static_cast<double>(singles[i]));
        ASSERT_EQ(std::memcmp(whole.points.attributes[0].as<float>() + i, &singles[i], 4), 0);
        ASSERT_EQ(whole.raw<double>("time_stamp", i), doubles[i]);
        ASSERT_EQ(whole.raw<std::int32_t>("scan_angle", i), integers[i]);
    }
    EXPECT_TRUE(whole.info.points_known);
}

TEST_F(E57, PosesTurnAndMove)
{
    // A quarter turn about z, not normalised: x becomes y, y becomes -x.
    const Whole whole = read({simple_scan(3, {}, E57TestScan::pose(2, 0, 0, 2, {4e6, 5e6, 0.5})),
                              simple_scan(3, {}, E57TestScan::pose(0, 0, 0, 0, {1, 2, 3})), simple_scan(3)});
    ASSERT_EQ(whole.points.size, 9u);
    for (std::size_t i = 0; i < 3; ++i) {
        const double x = double(i), y = 100 + x, z = -1 - x;
        EXPECT_NEAR(whole.position(i)[0], 4e6 - y, 1e-9);
        EXPECT_NEAR(whole.position(i)[1], 5e6 + x, 1e-9);
        EXPECT_EQ(whole.position(i)[2], z + 0.5);
        EXPECT_EQ(whole.position(3 + i), (Vec3d{x + 1, y + 2, z + 3}));
        EXPECT_EQ(whole.position(6 + i), (Vec3d{x, y, z}));
        EXPECT_EQ(whole.raw<std::uint32_t>("scan", i), 1u);
        EXPECT_EQ(whole.raw<std::uint32_t>("scan", 3 + i), 2u);
        EXPECT_EQ(whole.raw<std::uint32_t>("scan", 6 + i), 3u);
    }
    EXPECT_TRUE(any_mentions(whole.info.notes, "the quaternion of 1 scan is 0 0 0 0"));
}

// Against the sandwich product q p q* in long double.
TEST_F(E57, AnyRotation)
{
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal;
    for (int round = 0; round < 20; ++round) {
        const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
        const Whole whole = read({simple_scan(2, {}, E57TestScan::pose(w, x, y, z, {0, 0, 0}))});
        using Real = long double;
        const auto multiply = [](const std::array<Real, 4>& a, const std::array<Real, 4>& b) {
            return std::array<Real, 4>{a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
                                       a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                                       a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
                                       a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
        };
        const Real norm = Real(w) * w + Real(x) * x + Real(y) * y + Real(z) * z;
        for (std::size_t i = 0; i < 2; ++i) {
            const Real px = Real(i), py = 100 + px, pz = -1 - px;
            const auto turned = multiply(multiply({w, x, y, z}, {0, px, py, pz}), {w, -x, -y, -z});
            for (std::size_t a = 0; a < 3; ++a)
                EXPECT_NEAR(whole.position(i)[a], static_cast<double>(turned[a + 1] / norm),
                            1e-12);  // 100 * some 2^-52
        }
    }
}

TEST_F(E57, SphericalCoordinatesAndInvalidPoints)
{
    E57TestScan scan;
    const std::vector<double> range = {1, 2, 3, 4}, azimuth = {0, 1, -2, 3}, elevation = {0, 0.5, -1, 1.5};
    scan.fields = {Field::f64("sphericalRange", range), Field::f64("sphericalAzimuth", azimuth),
                   Field::f64("sphericalElevation", elevation),
                   Field::integer("sphericalInvalidState", 0, 2, {0, 1, 0, 2}),
                   Field::integer("intensity", 0, 100, {10, 11, 12, 13})};
    const Whole whole = read({scan});
    ASSERT_EQ(whole.points.size, 2u);
    EXPECT_FALSE(whole.info.points_known);
    EXPECT_EQ(whole.raw<std::uint8_t>("intensity", 1), 12);
    for (const auto& [at, i] : {std::pair<std::size_t, std::size_t>{0, 0}, {1, 2}}) {
        EXPECT_NEAR(whole.position(at)[0], range[i] * std::cos(elevation[i]) * std::cos(azimuth[i]), 1e-15);
        EXPECT_NEAR(whole.position(at)[1], range[i] * std::cos(elevation[i]) * std::sin(azimuth[i]), 1e-15);
        EXPECT_NEAR(whole.position(at)[2], range[i] * std::sin(elevation[i]), 1e-15);
    }
    const auto reader = open_reader(folder_ / "a.e57");
    PointBatch batch;
    while (reader->read(batch, 1)) EXPECT_EQ(batch.size, 1u);
    EXPECT_TRUE(any_mentions(reader->info().notes, "2 of 4 points dropped"));
}

TEST_F(E57, CartesianBeforeSpherical)
{
    E57TestScan scan = simple_scan(
        3, {Field::integer("cartesianInvalidState", 0, 2, {0, 2, 1}), Field::f64("sphericalRange", {7, 8, 9}),
            Field::f64("sphericalAzimuth", {0, 0, 0}), Field::f64("sphericalElevation", {0, 0, 0}),
            Field::integer("sphericalInvalidState", 0, 2, {0, 0, 2})});
    const Whole whole = read({scan});
    ASSERT_EQ(whole.points.size, 2u);
    EXPECT_EQ(whole.position(0), (Vec3d{0, 100, -1}));
    EXPECT_EQ(whole.position(1), (Vec3d{8, 0, 0})) << "where only the spherical ones are valid";
    EXPECT_EQ(whole.raw<double>("spherical_range", 0), 7);
}

TEST_F(E57, ManyPointsDropped)
{
    constexpr std::size_t count = 20000;
    std::vector<std::int64_t> state;
    for (std::size_t i = 0; i < count; ++i) state.push_back(i % 97 == 5 ? 0 : 2);
    const Whole whole = read({simple_scan(count, {Field::integer("cartesianInvalidState", 0, 2, state)})});
    ASSERT_EQ(whole.points.size, (count - 6) / 97 + 1);
    for (std::size_t i = 0; i < whole.points.size; ++i)
        ASSERT_EQ(whole.position(i)[0], static_cast<double>(97 * i + 5));
}

std::string colour_limits(int max)
{
    std::string xml = "<colorLimits type=\"Structure\">";
    for (const char* name : {"Red", "Green", "Blue"})
        xml += "<color" + std::string(name) + "Minimum type=\"Integer\">0</color" + name + "Minimum><color" + name +
               "Maximum type=\"Integer\">" + std::to_string(max) + "</color" + name + "Maximum>";
    return xml + "</colorLimits>";
}

TEST_F(E57, ColoursAreOfTheirRange)
{
    Whole whole = read({simple_scan(2, colours(255, {3, 255}))});
    EXPECT_EQ(whole.raw<std::uint8_t>("rgb", 1, 2), 255);
    whole = read({simple_scan(2, colours(65535, {3, 65280}))});
    EXPECT_EQ(whole.raw<std::uint16_t>("rgb", 1, 2), 65280);
    whole = read({simple_scan(2, colours(65535, {3, 255}), colour_limits(255))});
    EXPECT_EQ(whole.raw<std::uint8_t>("rgb", 1, 0), 255);
    whole = read({simple_scan(2, {Field::f32("colorRed", {0, 1}), Field::f32("colorGreen", {0.25f, 1}),
                                  Field::f32("colorBlue", {0, 0.1f})})});
    EXPECT_EQ(whole.raw<float>("rgb", 1, 2), 0.1f);
    whole = read({simple_scan(
        2, {Field::f32("colorRed", {0, 51}), Field::f32("colorGreen", {0.25f, 255}), Field::f32("colorBlue", {0, 102})},
        colour_limits(255))});
    EXPECT_FLOAT_EQ(whole.raw<float>("rgb", 1, 0), 0.2f);
    EXPECT_TRUE(any_mentions(whole.info.notes, "maximum, 255"));
}

TEST_F(E57, ColoursBeyondTheirLimitAreCutAndCounted)
{
    write_file(folder_ / "a.e57", e57_file({simple_scan(2, colours(65535, {3, 300}), colour_limits(255))}));
    const auto reader = open_reader(folder_ / "a.e57");
    PointBatch batch;
    ASSERT_TRUE(reader->read(batch, 10));
    EXPECT_EQ(batch.attributes[0].as<std::uint8_t>()[5], 255);
    EXPECT_TRUE(any_mentions(reader->info().notes, "3 colour values"));
}

TEST_F(E57, ScansOfDifferentFieldsBecomeOneCloud)
{
    const Whole whole = read(
        {simple_scan(2, colours(255, {1, 2})),
         simple_scan(2, {Field::integer("intensity", 0, 4095, {7, 4095}), Field::integer("rowIndex", 0, 9, {4, 5})}),
         simple_scan(2, colours(65535, {300, 65535})), simple_scan(2, {Field::integer("intensity", -5, 5, {-5, 5})})});
    ASSERT_EQ(whole.points.size, 8u);
    EXPECT_EQ(whole.raw<std::uint16_t>("rgb", 1, 0), 2 * 257);
    EXPECT_EQ(whole.raw<std::uint16_t>("rgb", 2, 0), 0);
    EXPECT_EQ(whole.raw<std::uint16_t>("rgb", 4, 1), 300);
    EXPECT_EQ(whole.raw<std::int16_t>("intensity", 0), 0);
    EXPECT_EQ(whole.raw<std::int16_t>("intensity", 3), 4095);
    EXPECT_EQ(whole.raw<std::int16_t>("intensity", 6), -5);
    EXPECT_EQ(whole.raw<std::uint8_t>("row_index", 3), 5);
    EXPECT_TRUE(any_mentions(whole.info.notes, "2 of 4 scans have no 'intensity'"));
    EXPECT_TRUE(any_mentions(whole.info.notes, "converted to 16 bits"));
}

TEST_F(E57, AttributesOfOneNameAndTwoScalesAreDoubles)
{
    const Whole whole = read({simple_scan(1, {Field::integer("intensity", 0, 10, {3}, "scale=\"0.5\"")}),
                              simple_scan(1, {Field::f32("intensity", {0.25f})})});
    EXPECT_EQ(whole.raw<double>("intensity", 0), 1.5);
    EXPECT_EQ(whole.raw<double>("intensity", 1), 0.25);
    EXPECT_TRUE(any_mentions(whole.info.notes, "'intensity' has different number types"));
}

TEST_F(E57, FieldsOfExtensions)
{
    const Whole whole = read({simple_scan(
        1, {Field::f32("nor:normalX", {0.6f}), Field::f32("nor:normalY", {0.8f}), Field::f32("nor:normalZ", {0.f}),
            Field::integer("las:pointSourceId", 0, 65535, {77}), Field::integer("nor:scan", 0, 1, {1}),
            Field::integer("returnIndex", 0, 1, {1}), Field::integer("returnCount", 0, 7, {2})})});
    EXPECT_EQ(whole.raw<float>("normal", 0, 1), 0.8f);
    EXPECT_EQ(whole.raw<std::uint16_t>("point_source_id", 0), 77);
    EXPECT_EQ(whole.raw<std::uint8_t>("nor:scan", 0), 1);
    EXPECT_EQ(whole.raw<std::uint8_t>("return_index", 0), 1);
    EXPECT_EQ(whole.raw<std::uint8_t>("number_of_returns", 0), 2);
}

TEST_F(E57, FieldsOfOneNameGetNumbers)
{
    const std::vector<Field> twice = {Field::integer("nor:a", 0, 9, {1}), Field::integer("nor:a", 0, 9, {2}),
                                      Field::integer("nor:a_2", 0, 9, {3}), Field::integer("nor:a", 0, 9, {4})};
    const Whole whole = read({simple_scan(1, twice), simple_scan(1, twice)});
    ASSERT_EQ(whole.info.schema.size(), 5u);  // and the scan
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(whole.raw<std::uint8_t>("nor:a", i), 1);
        EXPECT_EQ(whole.raw<std::uint8_t>("nor:a_2", i), 2);
        EXPECT_EQ(whole.raw<std::uint8_t>("nor:a_2_2", i), 3);
        EXPECT_EQ(whole.raw<std::uint8_t>("nor:a_3", i), 4);
    }
}

TEST_F(E57, Metadata)
{
    const Whole whole = read({simple_scan(1, {}, "<guid type=\"String\">g1</guid><name type=\"String\">east</name>")},
                             1, "<coordinateMetadata type=\"String\">EPSG:25832</coordinateMetadata>");
    const auto value = [&](const std::string& key) {
        for (const Metadata& m : whole.info.metadata)
            if (m.key == key) return std::string(reinterpret_cast<const char*>(m.value.data()), m.value.size());
        return std::string("missing");
    };
    EXPECT_EQ(value("e57.scan/1/name"), "east");
    EXPECT_EQ(value("e57.scan/1/guid"), "g1");
    EXPECT_EQ(value("e57.scan/1/pose"), "missing");
    const Whole posed = read({simple_scan(1, {}, E57TestScan::pose(0.5, 0.5, 0.5, 0.5, {4e6, 5e6, 0.5}))});
    const auto& blocks = posed.info.metadata;
    const auto pose =
        std::find_if(blocks.begin(), blocks.end(), [](const Metadata& m) { return m.key == "e57.scan/1/pose"; });
    ASSERT_NE(pose, blocks.end());
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(pose->value.data()), pose->value.size()),
              "4000000 5000000 0.5 0.5 0.5 0.5 0.5");
    EXPECT_EQ(value("e57.coordinateMetadata"), "EPSG:25832");
    EXPECT_TRUE(mentions(value("e57.xml"), "<?xml") && mentions(value("e57.xml"), "recordCount=\"1\""));
    EXPECT_EQ(whole.info.format, "E57 1.0, 1 scan");
}

TEST_F(E57, NoScansAndNoPoints)
{
    EXPECT_EQ(read({}).points.size, 0u);
    EXPECT_EQ(read({simple_scan(0)}).points.size, 0u);
    EXPECT_EQ(read({simple_scan(0), simple_scan(2), simple_scan(0)}).points.size, 2u);
}

TEST(E57Samples, EdgeAndBadFiles)
{
    PCM_REQUIRE_SAMPLE("edge/empty.e57");
    if (decoders_are_missing()) GTEST_SKIP() << "built without the decoders of LAZ and E57";
    EXPECT_EQ(read_whole(sample("edge/empty.e57")).points.size, 0u);
    EXPECT_EQ(read_whole(sample("edge/InvalidCVHeader.e57")).points.size, 0u);
    const Error error = error_of([&] { open_reader(sample("bad/bad-crc.e57")); });
    EXPECT_EQ(error.code(), ErrorCode::corrupt);
    EXPECT_TRUE(mentions(error.what(), "page 0, from byte 0")) << error.what();
}

// The same model in doubles and in integers of 32 bits.
TEST(E57Samples, TwoEncodingsOfOneCloud)
{
    PCM_REQUIRE_SAMPLE("e57/bunnyDouble.e57");
    if (decoders_are_missing()) GTEST_SKIP() << "built without the decoders of LAZ and E57";
    const Whole doubles = read_whole(sample("e57/bunnyDouble.e57")),
                integers = read_whole(sample("e57/bunnyInt32.e57"));
    ASSERT_EQ(doubles.points.size, 30571u);
    ASSERT_EQ(integers.points.size, 30571u);
    for (std::size_t i = 0; i < doubles.points.size; ++i)
        for (std::size_t a = 0; a < 3; ++a) ASSERT_NEAR(doubles.position(i)[a], integers.position(i)[a], 1e-6);
}

}  // namespace
}  // namespace pcm::test
