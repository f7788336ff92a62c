// Clouds of any attributes written as LAS: some become fields, others extra bytes.
#include "tests/io/las/las_clouds.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

namespace pcm::test {
namespace {

// Attributes without a field become extra bytes of the same name and type.
TEST(LasWriter, RandomSchemasRoundTrip)
{
    static constexpr ScalarType types[] = {ScalarType::i8,  ScalarType::u8,  ScalarType::i16, ScalarType::u16,
                                           ScalarType::i32, ScalarType::u32, ScalarType::i64, ScalarType::u64,
                                           ScalarType::f32, ScalarType::f64};
    static constexpr const char* names[] = {"intensity",      "normal",    "gps_time",       "rgb",
                                            "classification", "nir",       "radius",         "x y",
                                            "scan_angle",     "user_data", "wave_direction", "é ü ß"};
    std::mt19937_64 random(5);
    TemporaryFolder folder;
    for (int round = 0; round < 120; ++round) {
        Schema schema;
        for (const char* name : names) {
            if (random() % 2) continue;
            Attribute attribute{name, types[random() % 10], static_cast<std::uint32_t>(1 + random() % 5), 1, 0, {}};
            if (random() % 8 == 0) attribute.components = 33;
            if (random() % 4 == 0) attribute.scale = 0.25;
            if (random() % 4 == 0) attribute.offset = -17.5;
            schema.add(attribute);
        }
        const Whole cloud = gridded_cloud(schema, random() % 300, random());
        for (const std::string& extension : las_extensions()) {
            SCOPED_TRACE(std::to_string(round) + " " + extension);
            const auto path = folder / ("a." + extension);
            write_cloud(path, cloud);
            const Whole copy = read_whole(path);
            ASSERT_EQ(copy.points.size, cloud.points.size);
            EXPECT_EQ(copy.points.grid_xyz, cloud.points.grid_xyz);
            EXPECT_EQ(copy.info.grid, cloud.info.grid);
            for (std::size_t i = 0; i < schema.size(); ++i) {
                const auto found = copy.info.schema.find(schema[i].name);
                ASSERT_TRUE(found) << schema[i].name;
                const Attribute& attribute = copy.info.schema[*found];
                ASSERT_EQ(attribute.components, schema[i].components);
                const bool colours = schema[i].name == "rgb" && schema[i].type == ScalarType::u8 &&
                                     schema[i].components == 3 && schema[i].scale == 1 && schema[i].offset == 0;
                if (attribute.type == schema[i].type) {
                    EXPECT_EQ(attribute, schema[i]);
                    EXPECT_EQ(std::memcmp(copy.points.attributes[*found].data(), cloud.points.attributes[i].data(),
                                          cloud.points.attributes[i].bytes()),
                              0)
                        << schema[i].name;
                    continue;
                }
                // The field of the point format is of a larger type.
                EXPECT_GT(size_of(attribute.type), size_of(schema[i].type));
                EXPECT_EQ(attribute.scale, schema[i].scale);
                EXPECT_EQ(attribute.offset, schema[i].offset);
                for (std::size_t p = 0; p < cloud.points.size; ++p)
                    for (std::uint32_t c = 0; c < attribute.components; ++c) {
                        const double before = cloud.points.attributes[i].value(p, c);
                        const double after = copy.points.attributes[*found].value(p, c);
                        ASSERT_TRUE(after == (colours ? 257 * before : before) ||
                                    (std::isnan(after) && std::isnan(before)))
                            << schema[i].name;
                    }
            }
        }
    }
}

// Names that other programs know as normals; a cloud that has attributes of these names keeps both.
TEST(LasWriter, NormalsAreNormalXYZ)
{
    TemporaryFolder folder;
    const auto path = folder / "a.las";
    const auto has = [&](const std::string& name) {
        std::ifstream file(path, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        return bytes.find(name + std::string(32 - name.size(), '\0')) != std::string::npos;
    };
    const Attribute normal{"normal", ScalarType::f32, 3, 1, 0, "by hand"}, gap{"gap", ScalarType::u8, 1, 1, 0, {}},
        other{"normaly", ScalarType::f64, 1, 1, 0, {}};
    for (const Schema& schema : {schema_of({normal, gap}), schema_of({gap, normal, other})}) {
        const Whole cloud = gridded_cloud(schema, 50, 3);
        write_cloud(path, cloud);
        const bool plain = !schema.find("normaly");
        for (const char* name : {"NormalX", "NormalY", "NormalZ"}) EXPECT_EQ(has(name), plain) << name;
        EXPECT_EQ(has("normal"), !plain);
        const Whole copy = read_whole(path);
        for (const Attribute& attribute : schema) {
            const auto place = copy.info.schema.find(attribute.name);
            ASSERT_TRUE(place) << attribute.name;
            EXPECT_EQ(copy.info.schema[*place], attribute);
            const Column& before = cloud.points.attributes[*schema.find(attribute.name)];
            EXPECT_EQ(std::memcmp(copy.points.attributes[*place].data(), before.data(), before.bytes()), 0);
        }
    }
}

TEST(LasWriter, TheFormatIsTheSmallestWithAFieldForEverything)
{
    const Attribute intensity{"intensity", ScalarType::u16, 1, 1, 0, {}},
        time{"gps_time", ScalarType::f64, 1, 1, 0, {}}, rgb{"rgb", ScalarType::u16, 3, 1, 0, {}},
        nir{"nir", ScalarType::u16, 1, 1, 0, {}}, classes{"classification", ScalarType::u8, 1, 1, 0, {}},
        other{"other", ScalarType::f32, 1, 1, 0, {}};
    const std::pair<std::vector<Attribute>, std::string> cases[] = {
        {{}, "1.2, point format 0"},
        {{intensity, other}, "1.2, point format 0"},
        {{time}, "1.2, point format 1"},
        {{rgb}, "1.2, point format 2"},
        {{rgb, time}, "1.2, point format 3"},
        {{classes}, "1.4, point format 6"},
        {{classes, rgb}, "1.4, point format 7"},
        {{nir}, "1.4, point format 8"},
        {{rgb, nir}, "1.4, point format 8"},
    };
    TemporaryFolder folder;
    for (const auto& [attributes, format] : cases) {
        write_cloud(folder / "a.las", gridded_cloud(schema_of(attributes), 3, 1));
        EXPECT_EQ(open_reader(folder / "a.las")->info().format, "LAS " + format);
    }
}

TEST(LasWriter, ColoursAndIntensityOfFloatsAreKeptExactlyAndRoundedInTheFields)
{
    TemporaryFolder folder;
    Whole cloud = gridded_cloud(
        schema_of({{"rgb", ScalarType::f32, 3, 1, 0, {}}, {"intensity", ScalarType::f64, 1, 1, 0, {}}}), 2, 1);
    const float colours[] = {0, 0.5f, 1, 2, -1, std::nanf("")};
    std::memcpy(cloud.points.attributes[0].data(), colours, sizeof colours);
    const double intensity[] = {1234.4, 1e9};
    std::memcpy(cloud.points.attributes[1].data(), intensity, sizeof intensity);
    const Written written = write_cloud(folder / "a.las", cloud);
    EXPECT_TRUE(any_mentions(written.notes, "'rgb' is f32 x 3"));
    EXPECT_TRUE(any_mentions(written.notes, "'intensity' is f64"));
    const Whole copy = read_whole(folder / "a.las");
    for (const char* name : {"rgb", "intensity"}) {
        const std::size_t before = *cloud.info.schema.find(name), after = *copy.info.schema.find(name);
        EXPECT_EQ(cloud.info.schema[before], copy.info.schema[after]);
        EXPECT_EQ(std::memcmp(cloud.points.attributes[before].data(), copy.points.attributes[after].data(),
                              cloud.points.attributes[before].bytes()),
                  0);
    }
    // The fields that other software reads.
    EXPECT_EQ(copy.info.format, "LAS 1.2, point format 2");
    const std::string bytes = read_bytes(folder / "a.las");
    const std::size_t first = 227 + 54 + 2 * 192, second = first + 26 + 12 + 8;
    EXPECT_EQ(bytes.substr(first + 12, 2), Bytes().put(std::uint16_t{1234}).data);
    EXPECT_EQ(bytes.substr(second + 12, 2), Bytes().put(std::uint16_t{65535}).data);
    Bytes rounded;
    for (const int c : {0, 32768, 65535}) rounded.put(static_cast<std::uint16_t>(c));
    EXPECT_EQ(bytes.substr(first + 20, 6), rounded.data);
    EXPECT_EQ(bytes.substr(second + 20, 6), Bytes().put(std::uint16_t{65535}).put(0u).data) << "2, -1 and NaN";
    // And again: LAS to LAS.
    write_cloud(folder / "b.las", copy);
    expect_same_cloud(copy, read_whole(folder / "b.las"));
}

TEST(LasWriter, ValuesThatNeedMoreBitsAreCounted)
{
    TemporaryFolder folder;
    Whole cloud = gridded_cloud(schema_of({{"return_number", ScalarType::u8, 1, 1, 0, {}}}), 100, 1);
    for (std::size_t i = 0; i < 100; ++i)
        cloud.points.attributes[0].as<std::uint8_t>()[i] = static_cast<std::uint8_t>(i % 10);
    const Written written = write_cloud(folder / "a.las", cloud);
    EXPECT_TRUE(any_mentions(written.notes, "20 values of 'return_number'")) << written.notes.size();
    const Whole copy = read_whole(folder / "a.las");
    for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(copy.value("return_number", i), std::min<double>(i % 10, 7));
}

TEST(LasWriter, NamesAreCutAndStayDifferent)
{
    TemporaryFolder folder;
    const std::string stem(31, 'n');
    std::vector<Attribute> attributes;
    for (const char* ending : {"é1", "é2", "é3"}) attributes.push_back({stem + ending, ScalarType::i64, 1, 1, 0, {}});
    attributes.push_back({stem + "é", ScalarType::f32, 40, 1, 0, std::string(40, 'd')});
    const Whole cloud = gridded_cloud(schema_of(attributes), 10, 1);
    const Written written = write_cloud(folder / "a.las", cloud);
    EXPECT_TRUE(any_mentions(written.notes, "32 bytes"));
    const Whole copy = read_whole(folder / "a.las");
    const std::size_t fields = copy.info.schema.size() - attributes.size();
    for (std::size_t i = 0; i < attributes.size(); ++i) {
        EXPECT_EQ(copy.info.schema[fields + i].components, attributes[i].components);
        EXPECT_EQ(std::memcmp(copy.points.attributes[fields + i].data(), cloud.points.attributes[i].data(),
                              cloud.points.attributes[i].bytes()),
                  0);
    }
    EXPECT_EQ(copy.info.schema[fields].name, stem);
}

TEST(LasWriter, ManyComponentsNeedAnExtendedVlr)
{
    TemporaryFolder folder;
    const Whole cloud = gridded_cloud(schema_of({{"histogram", ScalarType::f32, 400, 1, 0, {}},
                                                 {"plain", ScalarType::u8, 300, 1, 0, {}},
                                                 {"extra_bytes", ScalarType::u8, 700, 1, 0, {}}}),
                                      50, 1);
    for (const std::string& extension : las_extensions()) {
        const auto path = folder / ("a." + extension);
        write_cloud(path, cloud);
        const Whole copy = read_whole(path);
        const std::size_t fields = copy.info.schema.size() - 3;
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(copy.info.schema[fields + i], cloud.info.schema[i]);
            EXPECT_EQ(std::memcmp(copy.points.attributes[fields + i].data(), cloud.points.attributes[i].data(),
                                  cloud.points.attributes[i].bytes()),
                      0);
        }
    }
    const Error error = error_of([&] {
        create_writer(folder / "b.las", gridded_cloud(schema_of({{"h", ScalarType::f64, 9000, 1, 0, {}}}), 1, 1).info);
    });
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_TRUE(mentions(error.what(), "72020 bytes")) << error.what();
}

}  // namespace
}  // namespace pcm::test
