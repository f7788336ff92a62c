// The version and the point format that a cloud is written as, and the names and numbers that other software finds
// there.
#include "pcm/cloud/with_type.h"
#include "pcm/io/las/las_fields.h"
#include "pcm/io/las/las_layout.h"
#include "tests/io/las/las_clouds.h"
#include "tests/io/random_cloud.h"

#include <cmath>
#include <set>

namespace pcm::test {
namespace {

WriteOptions surveyed(const Whole& cloud, std::optional<unsigned> version = {})
{
    WriteOptions options;
    options.las_version = version;
    options.survey = survey_of(cloud.info, cloud.points, "las", options);
    return options;
}

// The names in the description of the extra bytes.
std::vector<std::string> extra_names(const FileInfo& info)
{
    std::vector<std::string> names;
    for (const Metadata& block : info.metadata)
        if (block.key.find("LASF_Spec/4") != std::string::npos)
            for (std::size_t at = 0; at + 192 <= block.value.size(); at += 192)
                names.emplace_back(reinterpret_cast<const char*>(&block.value[at + 4]));
    return names;
}

// A field of the record of point `i`, as other software finds it.
template <class T>
T raw_field(const std::string& bytes, std::size_t i, std::size_t offset)
{
    std::uint32_t start = 0;
    std::uint16_t length = 0;
    std::memcpy(&start, &bytes[96], 4);
    std::memcpy(&length, &bytes[105], 2);
    T value;
    std::memcpy(&value, &bytes[start + i * length + offset], sizeof value);
    return value;
}

void expect_same_attributes(const Whole& before, const Whole& after)
{
    for (std::size_t i = 0; i < before.info.schema.size(); ++i) {
        const auto k = after.info.schema.find(before.info.schema[i].name);
        ASSERT_TRUE(k) << before.info.schema[i].name;
        EXPECT_EQ(after.info.schema[*k], before.info.schema[i]) << before.info.schema[i].name;
        ASSERT_EQ(after.points.attributes[*k].bytes(), before.points.attributes[i].bytes());
        EXPECT_EQ(std::memcmp(after.points.attributes[*k].data(), before.points.attributes[i].data(),
                              before.points.attributes[i].bytes()),
                  0)
            << before.info.schema[i].name;
    }
}

TEST(LasTarget, VersionAndFormatOfTheSource)
{
    std::mt19937_64 random(1);
    TemporaryFolder folder;
    for (int minor = 0; minor <= 4; ++minor)
        for (int format = 0; format <= 10; ++format) {
            if (las::first_minor(static_cast<unsigned>(format)) > static_cast<unsigned>(minor)) continue;
            LasFile file = random_las(random, minor, format, 300);
            file.vlrs = {{"LASF_Projection", 34735, "keys"}};
            const Whole source = read_whole(write_file(folder / "source.las", file.bytes()));
            for (const std::string& extension : las_extensions()) {
                SCOPED_TRACE(std::to_string(minor) + " " + std::to_string(format) + " " + extension);
                const auto path = folder / ("copy." + extension);
                write_cloud(path, source, surveyed(source));
                const Whole copy = read_whole(path);
                EXPECT_TRUE(mentions(copy.info.format,
                                     "1." + std::to_string(minor) + ", point format " + std::to_string(format)))
                    << copy.info.format;
                EXPECT_TRUE(copy.info.notes.empty()) << copy.info.notes[0];
                expect_same_cloud(source, copy);
                EXPECT_EQ(without_header(source.info), without_header(copy.info));
                const std::string bytes = read_bytes(path);
                EXPECT_EQ(raw_field<std::uint16_t>(bytes, 0, 0) >= 0, true);
                EXPECT_EQ(bytes.substr(94, 2), Bytes().put(static_cast<std::uint16_t>(file.header_size())).data);
                if (minor == 0) EXPECT_EQ(bytes.substr(227, 2), "\xBB\xAA") << "the signature of a VLR of 1.0";
            }
        }
}

// Every version of every format: no number is lost, whatever the version has no field for.
TEST(LasTarget, EveryVersionOnRequestKeepsEverything)
{
    std::mt19937_64 random(2);
    TemporaryFolder folder;
    for (int format = 0; format <= 10; ++format) {
        const LasFile file = random_las(random, 4, format, 500, 3);
        const Whole source = read_whole(write_file(folder / "source.las", file.bytes()));
        for (unsigned minor = 0; minor <= 4; ++minor)
            for (const std::string& extension : las_extensions()) {
                SCOPED_TRACE(std::to_string(minor) + " " + std::to_string(format) + " " + extension);
                const auto path = folder / ("copy." + extension);
                const Written written = write_cloud(path, source, surveyed(source, minor));
                const Whole copy = read_whole(path);
                EXPECT_TRUE(mentions(copy.info.format, "1." + std::to_string(minor))) << copy.info.format;
                EXPECT_TRUE(copy.info.notes.empty()) << copy.info.notes[0];
                EXPECT_FALSE(any_mentions(written.notes, "clamped"));
                expect_same_attributes(source, copy);
                EXPECT_EQ(copy.points.grid_xyz, source.points.grid_xyz);
                if (las::first_minor(static_cast<unsigned>(format)) <= minor)
                    EXPECT_TRUE(mentions(copy.info.format, "format " + std::to_string(format))) << copy.info.format;
            }
    }
}

TEST(LasTarget, AnglesGoToTheFieldThatTheFormatHasForThem)
{
    TemporaryFolder folder;
    Whole cloud = gridded_cloud(schema_of({{"scan_angle", ScalarType::i16, 1, 0.006, 0, {}}}), 3, 1);
    const std::int16_t angles[] = {-5000, 2084, 30000};
    std::memcpy(cloud.points.attributes[0].data(), angles, sizeof angles);
    write_cloud(folder / "a.las", cloud, surveyed(cloud, 2));
    const std::string bytes = read_bytes(folder / "a.las");
    const int degrees[] = {-30, 13, 127};  // 12.504 and 180, which a byte does not hold
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(raw_field<std::int8_t>(bytes, i, 16), degrees[i]);
    expect_same_attributes(cloud, read_whole(folder / "a.las"));
}

TEST(LasTarget, WithoutASourceTheLowestVersionThatHoldsTheValues)
{
    TemporaryFolder folder;
    Whole cloud = gridded_cloud(
        schema_of({{"classification", ScalarType::u8, 1, 1, 0, {}}, {"return_number", ScalarType::u8, 1, 1, 0, {}}}), 2,
        1);
    const auto format = [&](std::uint8_t most_class, std::uint8_t most_return) {
        for (std::uint8_t i = 0; i < 2; ++i) {
            cloud.points.attributes[0].as<std::uint8_t>()[i] = i ? most_class : std::uint8_t{2};
            cloud.points.attributes[1].as<std::uint8_t>()[i] = i ? most_return : std::uint8_t{1};
        }
        write_cloud(folder / "a.las", cloud, surveyed(cloud));
        const Whole copy = read_whole(folder / "a.las");
        expect_same_attributes(cloud, copy);
        return copy.info.format;
    };
    EXPECT_EQ(format(31, 7), "LAS 1.2, point format 0");
    EXPECT_EQ(format(32, 7), "LAS 1.4, point format 6");
    EXPECT_EQ(format(31, 8), "LAS 1.4, point format 6");
    EXPECT_EQ(format(255, 15), "LAS 1.4, point format 6");
    format(255, 200);
}

TEST(LasTarget, WhatAVersionHasNoRoomFor)
{
    std::mt19937_64 random(3);
    TemporaryFolder folder;
    LasFile file = random_las(random, 4, 3, 10);
    file.vlrs = {{"LASF_Projection", 2112, "PROJCS[]"}};
    file.evlrs = {{"far", 9, std::string(70000, 'e')}, {"near", 8, "value"}};
    const Whole source = read_whole(write_file(folder / "source.las", file.bytes()));
    const Written written = write_cloud(folder / "a.las", source, surveyed(source, 2));
    EXPECT_TRUE(any_mentions(written.notes, "' of 70000 bytes is left out"));
    EXPECT_TRUE(any_mentions(written.notes, "las.evlr/near/8"));
    EXPECT_TRUE(any_mentions(written.notes, "WKT"));
    const FileInfo info = open_reader(folder / "a.las")->info();
    EXPECT_EQ(info.format, "LAS 1.2, point format 3");
    std::set<std::string> keys;
    for (const Metadata& block : info.metadata) keys.insert(block.key);
    EXPECT_TRUE(keys.count("las.vlr/near/8/described") && keys.count("las.vlr/LASF_Projection/2112/described"));

    // Unasked, the version rises.
    Whole old = read_whole(write_file(folder / "old.las", random_las(random, 2, 3, 10).bytes()));
    old.info.metadata.push_back(metadata("las.evlr/far/9", "value"));
    EXPECT_TRUE(write_cloud(folder / "b.las", old).notes.empty());
    EXPECT_EQ(open_reader(folder / "b.las")->info().format, "LAS 1.4, point format 3");
    old.info.metadata.pop_back();
    old.info.points = 4294967296;
    write_cloud(folder / "b.las", old);
    EXPECT_EQ(open_reader(folder / "b.las")->info().format, "LAS 1.4, point format 3");
    // A source before 1.4 that has a coordinate system in WKT keeps its version.
    old.info.points = 10;
    old.info.metadata.push_back(metadata("las.vlr/LASF_Projection/2112", "PROJCS[]"));
    write_cloud(folder / "b.las", old);
    EXPECT_EQ(open_reader(folder / "b.las")->info().format, "LAS 1.2, point format 3");
    Whole plain = gridded_cloud({}, 1, 1);
    plain.info.metadata.push_back(metadata("las.vlr/LASF_Projection/2112", "PROJCS[]"));
    write_cloud(folder / "b.las", plain);
    EXPECT_EQ(open_reader(folder / "b.las")->info().format, "LAS 1.4, point format 0");

    WriteOptions options;
    options.las_version = 5;
    EXPECT_EQ(error_of([&] { create_writer(folder / "c.las", plain.info, options); }).code(),
              ErrorCode::invalid_argument);
    options.las_version = 2;
    Schema wide;
    for (std::size_t i = 0; i < 2; ++i) wide.add({"h" + std::to_string(i), ScalarType::f32, 200, 1, 0, {}});
    const Error error = error_of([&] { create_writer(folder / "c.las", gridded_cloud(wide, 1, 1).info, options); });
    EXPECT_TRUE(mentions(error.what(), "LAS 1.2 allows 65535")) << error.what();
}

// ------------------------------------------------------------------------------- names and numbers for other software

TEST(LasTarget, NoExtraBytesHaveTheNameOfAField)
{
    TemporaryFolder folder;
    for (unsigned format = 0; format <= 10; ++format)
        for (const auto& [type, components] :
             {std::pair{ScalarType::u64, 1u}, {ScalarType::i64, 2u}, {ScalarType::f64, 5u}}) {
            std::vector<Attribute> attributes;
            for (const Attribute& field : las::fields_of_format(format).schema)
                attributes.push_back({field.name, type, components, 1, 0, {}});
            for (const char* name : {"X", "Y", "Z", "x", "red", "raw_classification", "wavepacket_index"})
                attributes.push_back({name, ScalarType::u8, 1, 1, 0, {}});
            attributes.push_back({"intensity_exact", ScalarType::u8, 1, 1, 0, {}});
            Whole cloud = gridded_cloud(schema_of(attributes), 20, format);
            SCOPED_TRACE(std::to_string(format) + " " + std::to_string(components));
            write_cloud(folder / "a.las", cloud, surveyed(cloud));
            const Whole copy = read_whole(folder / "a.las");
            unsigned written = 0;
            std::sscanf(copy.info.format.c_str(), "LAS 1.%*u, point format %u", &written);
            std::set<std::string> all;
            for (const std::string& name : extra_names(copy.info)) {
                EXPECT_FALSE(las::is_name_of_a_field(written, name)) << name;
                EXPECT_TRUE(all.insert(name).second) << name;
            }
            // Those that could be mistaken get a number at the end of their name.
            EXPECT_EQ(all.count("X") + all.count("x") + all.count("raw_classification"), 0u);
            Whole fields = cloud;
            fields.info.schema = schema_of({attributes.begin(), attributes.end() - 8});
            expect_same_attributes(fields, copy);
            EXPECT_TRUE(copy.info.schema.find("intensity_exact_2"));
        }
}

// What this program wrote before the exact values had a name of their own.
TEST(LasTarget, ExactValuesUnderTheOldNameAreRead)
{
    TemporaryFolder folder;
    std::mt19937_64 random(4);
    LasFile file = random_las(random, 4, 1, 50, 4);
    std::string descriptor = extra_descriptor(9, 0, "intensity");
    descriptor.replace(160, 32, Bytes().text(las::exact_description, 32).data);
    file.vlrs = {{"LASF_Spec", 4, descriptor}};
    for (std::size_t i = 0; i < file.records.size(); ++i)
        file.records[i].extra = Bytes().put(0.25f * static_cast<float>(i)).data;
    const Whole old = read_whole(write_file(folder / "old.las", file.bytes()));
    const Attribute& attribute = old.info.schema[*old.info.schema.find("intensity")];
    EXPECT_EQ(attribute.type, ScalarType::f32);
    EXPECT_EQ(old.value("intensity", 3), 0.75);
    // And written again, under the new name.
    write_cloud(folder / "new.las", old, surveyed(old));
    const Whole now = read_whole(folder / "new.las");
    EXPECT_EQ(extra_names(now.info), std::vector<std::string>{"intensity_exact"});
    expect_same_attributes(old, now);
}

struct Scaled {
    const char* name;
    ScalarType type;
    std::vector<double> values;
    std::vector<unsigned> field;
    std::string note;
};

TEST(LasTarget, IntensitiesAndColoursFillTheirFields)
{
    TemporaryFolder folder;
    const Scaled cases[] = {
        {"intensity", ScalarType::f32, {0, 0.5, 1}, {0, 32768, 65535}, "times 65535"},
        {"intensity", ScalarType::f64, {0.25, NAN, INFINITY}, {16384, 0, 65535}, "times 65535"},
        {"intensity", ScalarType::f32, {0, 17, 255}, {0, 17, 255}, "rounded"},
        {"intensity", ScalarType::f32, {0.5, 300.25, 65535}, {0, 300, 65535}, "rounded"},
        {"intensity", ScalarType::f32, {0, 1.5, 3}, {0, 32768, 65535}, "range, 0 to 3, spread over"},
        {"intensity", ScalarType::i16, {-2048, 0, 2047}, {0, 32776, 65535}, "range, -2048 to 2047, spread over"},
        {"intensity", ScalarType::u32, {0, 100, 1000000}, {0, 7, 65535}, "range, 0 to 1000000, spread over"},
        {"intensity", ScalarType::i32, {0, 1, 2}, {0, 1, 2}, "rounded"},
        {"rgb", ScalarType::f32, {0, 0.5, 1}, {0, 32768, 65535}, "times 65535"},
        {"rgb", ScalarType::f32, {0, 127.5, 255}, {0, 32768, 65535}, "times 257"},
        {"rgb", ScalarType::i32, {0, 128, 255}, {0, 32896, 65535}, "times 257"},
        {"rgb", ScalarType::f64, {0, 300, 65535}, {0, 300, 65535}, "rounded"},
    };
    for (const Scaled& c : cases) {
        SCOPED_TRACE(std::string(c.name) + " " + std::string(name_of(c.type)) + " " + c.note);
        const bool colours = std::string(c.name) == "rgb";
        Whole cloud = gridded_cloud(schema_of({{c.name, c.type, colours ? 3u : 1u, 1, 0, {}}}), colours ? 1 : 3, 1);
        for (std::size_t i = 0; i < 3; ++i)
            with_type(c.type, [&](auto zero) {
                const auto value = static_cast<decltype(zero)>(c.values[i]);
                std::memcpy(cloud.points.attributes[0].data() + i * sizeof value, &value, sizeof value);
            });
        const Written written = write_cloud(folder / "a.las", cloud, surveyed(cloud));
        EXPECT_TRUE(any_mentions(written.notes, c.note)) << written.notes.at(0);
        EXPECT_TRUE(any_mentions(written.notes, "'" + std::string(c.name) + "_exact' keep it exactly"));
        const std::string bytes = read_bytes(folder / "a.las");
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(raw_field<std::uint16_t>(bytes, colours ? 0 : i, colours ? 20 + 2 * i : 12), c.field[i]) << i;
        const Whole copy = read_whole(folder / "a.las");
        EXPECT_EQ(extra_names(copy.info), std::vector<std::string>{std::string(c.name) + "_exact"});
        expect_same_attributes(cloud, copy);
    }
}

TEST(LasTarget, ColoursOf8BitsAreTimes257)
{
    TemporaryFolder folder;
    const Whole cloud = gridded_cloud(schema_of({{"rgb", ScalarType::u8, 3, 1, 0, {}}}), 500, 1);
    write_cloud(folder / "a.las", cloud, surveyed(cloud));
    const std::string bytes = read_bytes(folder / "a.las");
    for (std::size_t i = 0; i < cloud.points.size; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_EQ(raw_field<std::uint16_t>(bytes, i, 20 + 2 * c), 257 * cloud.points.attributes[0].value(i, c))
                << i;
}

TEST(LasTarget, ScaledAttributesGoToFieldsAsTheirValues)
{
    TemporaryFolder folder;
    Whole cloud = gridded_cloud(schema_of({{"gps_time", ScalarType::i32, 1, 0.25, 100, {}}}), 1, 1);
    *cloud.points.attributes[0].as<std::int32_t>() = 42;
    write_cloud(folder / "a.las", cloud, surveyed(cloud));
    EXPECT_EQ(raw_field<double>(read_bytes(folder / "a.las"), 0, 20), 110.5);
    expect_same_attributes(cloud, read_whole(folder / "a.las"));
}

}  // namespace
}  // namespace pcm::test
