// What other programs find in PLY and PCD: values instead of scaled integers, colours of 8 bits, floats. And that this
// library finds the cloud's own numbers again.
#include "pcm/io/records/stored_values.h"

#include "tests/io/cloud_copy.h"
#include "tests/io/random_cloud.h"

#include <cmath>
#include <limits>

namespace pcm::test {
namespace {

class StoredValues : public testing::TestWithParam<std::tuple<std::string, bool>> {
protected:
    const std::string& extension() const { return std::get<0>(GetParam()); }
    bool ascii() const { return std::get<1>(GetParam()); }
    bool ply() const { return extension() == "ply"; }

    // One attribute, all points at 0 0 0.
    template <class T>
    static Whole cloud_of(const Attribute& attribute, const std::vector<T>& values)
    {
        Whole cloud;
        cloud.info.position_type = ScalarType::f32;
        cloud.info.schema.add(attribute);
        cloud.points.reset(cloud.info.schema, false, values.size() / attribute.components);
        for (auto& axis : cloud.points.xyz) std::fill(axis.begin(), axis.end(), 0);
        std::memcpy(cloud.points.attributes[0].data(), values.data(), values.size() * sizeof(T));
        return cloud;
    }

    // Writes with a survey, and expects every bit back. Returns what another program reads.
    Whole through_file(const Whole& cloud, WriteOptions options = {})
    {
        options.ascii = ascii();
        options.survey = survey_of(cloud.info, cloud.points, extension(), options);
        notes_ = test::write_cloud(file(), cloud, options).notes;
        const Whole own = read_whole(file());
        EXPECT_TRUE(own.info.notes.empty()) << own.info.notes[0];
        if (!options.colour_bits) {
            expect_same_schema(cloud.info.schema, own.info.schema);
            expect_same_points({cloud.info, cloud.points}, own);
        }
        return as_others_read();
    }

    Whole as_others_read() const
    {
        std::string bytes = read_bytes(file());
        const std::string comment = ply() ? "\ncomment pcm" : "\n# pcm";
        for (std::size_t at; (at = bytes.find(comment)) != std::string::npos;)
            bytes.erase(at, bytes.find('\n', at + 1) - at);
        return read_whole(write_file(folder_ / ("other." + extension()), bytes));
    }

    std::filesystem::path file() const { return folder_ / ("a." + extension()); }
    TemporaryFolder folder_;
    std::vector<std::string> notes_;
};

INSTANTIATE_TEST_SUITE_P(All, StoredValues, testing::Combine(testing::Values("ply", "pcd"), testing::Bool()),
                         [](const auto& p) {
                             return std::get<0>(p.param) + (std::get<1>(p.param) ? "_ascii" : "_binary");
                         });

TEST_P(StoredValues, ScaledIntegersAreWrittenAsTheirValues)
{
    const Whole angles = through_file(
        cloud_of<std::int16_t>({"scan_angle", ScalarType::i16, 1, 0.006, 0, {}}, {-30000, 30000, 1682, -32768, 32767}));
    EXPECT_TRUE(notes_.empty());
    EXPECT_EQ(angles.info.schema[0].type, ScalarType::f32);
    const double degrees[] = {-180, 180, 10.092, -196.608, 196.602};
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(angles.value("scan_angle", i), degrees[i], 1e-5);

    // Where floats would not name every integer, doubles do.
    const Whole times =
        through_file(cloud_of<std::uint32_t>({"time", ScalarType::u32, 1, 1e-6, 1e9, "s"}, {0, 1, 4294967295u}));
    EXPECT_EQ(times.info.schema[0].type, ScalarType::f64);
    EXPECT_EQ(times.value("time", 1), 1 * 1e-6 + 1e9);
    const Whole pair = through_file(cloud_of<std::uint8_t>({"pair", ScalarType::u8, 2, 0.5, -1, {}}, {0, 255, 3, 4}));
    EXPECT_EQ(ply() ? pair.value("pair_1", 0) : pair.value("pair", 0, 1), 126.5);
    const Whole normals = through_file(
        cloud_of<std::int8_t>({"normal", ScalarType::i8, 3, 1.0 / 127, 0, {}}, {-127, 0, 127, -128, 5, 6}));
    EXPECT_EQ(normals.info.schema[0].type, ScalarType::f32);
    EXPECT_NEAR(normals.value("normal", 0, 0), -1, 1e-6);
    EXPECT_NEAR(normals.value("normal", 0, 2), 1, 1e-6);
    // Raw numbers of 64 bits that are small.
    const Whole wide =
        through_file(cloud_of<std::int64_t>({"wide", ScalarType::i64, 1, 0.001, 0, {}}, {-5000, 123456789}));
    EXPECT_NEAR(wide.value("wide", 1), 123456.789, 1e-9);
    EXPECT_TRUE(notes_.empty());
}

TEST_P(StoredValues, WhatValuesDoNotHoldIsKeptBesideThem)
{
    const Whole reals = through_file(cloud_of<double>({"real", ScalarType::f64, 1, 0.1, 1e10, {}}, {0.25, -1e-300, 3}));
    EXPECT_TRUE(any_mentions(notes_, "real_raw")) << notes_.size();
    EXPECT_EQ(reals.value("real", 2), 3 * 0.1 + 1e10);
    EXPECT_EQ(reals.value("real_raw", 2), 3);
    const Whole wide =
        through_file(cloud_of<std::uint64_t>({"wide", ScalarType::u64, 1, 0.5, 0, {}}, {~std::uint64_t{0}, 2}));
    EXPECT_EQ(wide.value("wide", 1), 1);
    EXPECT_EQ(ply() ? wide.value("wide_raw_low", 0) : wide.value("wide_raw", 0), ply() ? 4294967295. : 0x1p64);
    const Whole normals = through_file(cloud_of<float>({"normal", ScalarType::f32, 3, 0.5, 0, {}}, {2, -2, 1}));
    EXPECT_EQ(normals.value("normal", 0, 1), -1);
}

TEST_P(StoredValues, ColoursOf16BitsAreShownWith8)
{
    const Attribute rgb{"rgb", ScalarType::u16, 3, 1, 0, {}};
    struct Case {
        std::vector<std::uint16_t> colours;
        std::array<int, 3> shown;
        bool whole;
    };
    for (const Case& c : {Case{{65535, 257, 0}, {255, 1, 0}, true}, Case{{65280, 256, 0}, {255, 1, 0}, true},
                          Case{{255, 1, 0}, {255, 1, 0}, true}, Case{{65535, 32768, 129}, {255, 128, 1}, false},
                          Case{{65535, 65535, 65535}, {255, 255, 255}, true}}) {
        const Whole shown = through_file(cloud_of<std::uint16_t>(rgb, c.colours));
        ASSERT_EQ(shown.info.schema[0].type, ScalarType::u8);
        for (std::uint32_t k = 0; k < 3; ++k) EXPECT_EQ(shown.value("rgb", 0, k), c.shown[k]);
        EXPECT_EQ(shown.info.schema.size(), c.whole ? 1u : ply() ? 4u : 2u);
        EXPECT_EQ(notes_.empty(), c.whole);
        if (!c.whole) EXPECT_EQ(ply() ? shown.value("green_exact", 0) : shown.value("rgb_exact", 0, 1), 32768);
    }
}

TEST_P(StoredValues, ColourBitsChooseOne)
{
    const Attribute rgb{"rgb", ScalarType::u16, 3, 1, 0, {}};
    const Whole cloud = cloud_of<std::uint16_t>(rgb, {65535, 32768, 129});
    WriteOptions options;
    options.colour_bits = 16;
    const Whole sixteen = through_file(cloud, options);
    EXPECT_EQ(sixteen.info.schema.size(), 1u);
    EXPECT_EQ(sixteen.info.schema[0], rgb);
    EXPECT_EQ(sixteen.value("rgb", 0, 1), 32768);
    options.colour_bits = 8;
    const Whole eight = through_file(cloud, options);
    EXPECT_EQ(eight.info.schema.size(), 1u);
    EXPECT_EQ(eight.info.schema[0].type, ScalarType::u8);
    EXPECT_EQ(eight.value("rgb", 0, 1), 128);
    EXPECT_TRUE(any_mentions(notes_, "rounded to 8 bits"));
    EXPECT_EQ(read_whole(file()).info.schema[0].type, ScalarType::u8);
}

TEST_P(StoredValues, ColoursOfOtherTypesAreShownToo)
{
    const auto shown = [&](const Whole& cloud) {
        const Whole other = through_file(cloud);
        return std::array<double, 3>{other.value("rgb", 0, 0), other.value("rgb", 0, 1), other.value("rgb", 0, 2)};
    };
    using Colour = std::array<double, 3>;
    EXPECT_EQ(shown(cloud_of<float>({"rgb", ScalarType::f32, 3, 1, 0, {}}, {1, 0.5f, -1})), (Colour{255, 128, 0}));
    EXPECT_EQ(shown(cloud_of<float>({"rgb", ScalarType::f32, 3, 1, 0, {}}, {255, 127.4f, 0})), (Colour{255, 127, 0}));
    EXPECT_EQ(shown(cloud_of<std::int32_t>({"rgb", ScalarType::i32, 3, 1, 0, {}}, {255, 7, 0})), (Colour{255, 7, 0}));
    EXPECT_EQ(shown(cloud_of<double>({"rgb", ScalarType::f64, 3, 1, 0, {}}, {65535, 257, 0})), (Colour{255, 1, 0}));
    EXPECT_EQ(shown(cloud_of<std::uint8_t>({"rgb", ScalarType::u8, 3, 1, 0, {}}, {255, 255, 255})),
              (Colour{255, 255, 255}));
    EXPECT_TRUE(notes_.empty());
}

TEST_P(StoredValues, IntegersOf64Bits)
{
    const Attribute id{"id", ScalarType::i64, 1, 1, 0, {}};
    const Whole small = through_file(cloud_of<std::int64_t>(id, {-5, (std::int64_t{1} << 53) - 1}));
    EXPECT_EQ(small.info.schema[0].type, ply() ? ScalarType::f64 : ScalarType::i64);
    EXPECT_EQ(small.value("id", 1), 0x1p53 - 1);
    EXPECT_TRUE(notes_.empty());
    const Whole large = through_file(cloud_of<std::int64_t>(id, {-5, (std::int64_t{1} << 53) + 1}));
    EXPECT_EQ(large.info.schema.size(), ply() ? 2u : 1u);
    if (ply()) EXPECT_TRUE(any_mentions(notes_, "id_low and id_high"));
}

// Another program has changed the numbers and left the comments.
TEST_P(StoredValues, ValuesBeyondTheTypeAreClampedAndCounted)
{
    if (!ascii()) return;
    through_file(cloud_of<std::uint8_t>({"part", ScalarType::u8, 1, 0.5, 0, {}}, {1, 2, 3}));
    std::string text = read_bytes(file());
    text.replace(text.rfind("0 0 0 1\n"), 8, "0 0 0 200\n");
    text.replace(text.rfind("0 0 0 1.5"), 9, "0 0 0 nan");
    const Whole changed = read_whole(write_file(file(), text));
    EXPECT_EQ(changed.value("part", 0), 1);
    EXPECT_EQ(changed.value("part", 1), 255);
    EXPECT_EQ(changed.value("part", 2), 0);
    const auto reader = open_reader(file());
    PointBatch batch;
    while (reader->read(batch, 2)) EXPECT_LE(batch.size, 2u);
    ASSERT_EQ(reader->info().notes.size(), 1u);
    EXPECT_TRUE(mentions(reader->info().notes[0], "2 values of 'part'")) << reader->info().notes[0];
}

// Comments are checked like everything else.
TEST_P(StoredValues, CommentsThatAreNotTrueAreNotFollowed)
{
    if (!ascii()) return;
    through_file(cloud_of<std::uint16_t>({"rgb", ScalarType::u16, 3, 1, 0, {}}, {65535, 32768, 129}));
    const std::string text = read_bytes(file());
    const std::string line = ply() ? "repeated red 3 red_exact" : "repeated rgb 1 rgb_exact";
    for (const std::string other : ply()
                                       ? std::vector<std::string>{"repeated red 9 red_exact", "repeated x 1 red_exact",
                                                                  "repeated red 3 none", "repeated none 1 red_exact"}
                                       : std::vector<std::string>{"repeated rgb 9 rgb_exact", "repeated x 1 rgb_exact",
                                                                  "repeated rgb 1 none", "repeated none 1 rgb_exact"}) {
        std::string changed = text;
        changed.replace(changed.find(line), line.size(), other);
        const Whole whole = read_whole(write_file(file(), changed));
        EXPECT_EQ(whole.info.notes.size(), 1u) << other;
        EXPECT_EQ(whole.info.schema.size(), 2u) << other;
    }
    std::string damaged = text;
    damaged.replace(damaged.find(line), line.size(), "repeated red");
    EXPECT_TRUE(any_mentions(read_whole(write_file(file(), damaged)).info.notes, "1 damaged comment"));
}

// MeshLab takes a float "intensity" for a grey instead of the colour.
TEST(PlyWriter, FloatIntensitiesBesideColoursHaveAnotherName)
{
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    for (const bool colours : {false, true})
        for (const ScalarType type : {ScalarType::f32, ScalarType::u16, ScalarType::f64}) {
            std::vector<Attribute> attributes{{"intensity", type, 1, 1, 0, {}}};
            if (colours) attributes.push_back({"rgb", ScalarType::u8, 3, 1, 0, {}});
            const RandomCloud cloud = random_cloud(random, PositionKind::single_precision, 10, true, attributes);
            write_cloud(folder / "a.ply", cloud, random);
            const std::string bytes = read_bytes(folder / "a.ply");
            EXPECT_EQ(mentions(bytes, "property float intensity\n"), type == ScalarType::f32 && !colours);
            EXPECT_EQ(mentions(bytes, "property float scalar_intensity\n"), type == ScalarType::f32 && colours);
            const Whole back = read_whole(folder / "a.ply");
            expect_same_schema(cloud.info.schema, back.info.schema);
            expect_same_points(cloud, back);
        }
}

// ------------------------------------------------------------------------------------------------- PCD

TEST(PcdWriter, IntensitiesAreFloatsAsInPcl)
{
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    RandomCloud cloud;
    cloud.info.position_type = ScalarType::f32;
    cloud.info.schema.add({"intensity", ScalarType::u16, 1, 1, 0, {}});
    cloud.points.reset(cloud.info.schema, false, 1);
    *cloud.points.attributes[0].as<std::uint16_t>() = 65535;
    write_cloud(folder / "a.pcd", cloud, random);
    const std::string bytes = read_bytes(folder / "a.pcd");
    EXPECT_TRUE(mentions(bytes, "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\n")) << bytes;
    EXPECT_EQ(bytes.substr(bytes.size() - 4), Bytes().put(65535.f).data);
    expect_same_points(cloud, read_whole(folder / "a.pcd"));
}

TEST(PcdWriter, IntensitiesAndNormalsThatFloatsDoNotHoldAreKeptBesideThem)
{
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    const RandomCloud cloud =
        random_cloud(random, PositionKind::single_precision, 10, true,
                     {{"intensity", ScalarType::u32, 1, 1, 0, {}}, {"normal", ScalarType::f64, 3, 1, 0, {}}});
    const auto notes = write_cloud(folder / "a.pcd", cloud, random);
    EXPECT_TRUE(any_mentions(notes, "intensity_exact") && any_mentions(notes, "normal_exact"));
    EXPECT_TRUE(mentions(read_bytes(folder / "a.pcd"),
                         "FIELDS x y z intensity intensity_exact normal_x normal_y normal_z normal_exact\n"
                         "SIZE 4 4 4 4 4 4 4 4 8\nTYPE F F F F U F F F F\nCOUNT 1 1 1 1 1 1 1 1 3\n"));
    const Whole back = read_whole(folder / "a.pcd");
    expect_same_schema(cloud.info.schema, back.info.schema);
    expect_same_points(cloud, back);
}

// Points of a grid of millimetres around `offset`.
RandomCloud on_grid(const Vec3d& offset, std::int32_t most)
{
    std::mt19937_64 random(2);
    RandomCloud cloud = random_cloud(random, PositionKind::grid, 2000, true, {});
    cloud.info.grid = Grid{{0.001, 0.001, 0.001}, offset};
    for (auto& axis : cloud.points.grid_xyz)
        for (auto& q : axis) q %= most;
    return cloud;
}

TEST(PcdWriter, FloatsWhereTheyHoldThePositions)
{
    TemporaryFolder folder;
    for (const bool ascii : {false, true})
        for (const bool small : {true, false}) {
            const RandomCloud cloud = on_grid({small ? 0. : 500000., 7, 0}, 2000000);
            WriteOptions options;
            options.ascii = ascii;
            options.survey = survey_of(cloud.info, cloud.points, "pcd");
            const auto writer = create_writer(folder / "a.pcd", cloud.info, options);
            writer->write(cloud.points);
            writer->finish();
            EXPECT_EQ(mentions(read_bytes(folder / "a.pcd"), "SIZE 4 4 4\n"), small);
            EXPECT_EQ(any_mentions(writer->notes(), "Open3D"), !small);
            EXPECT_LT(writer->position_error(), 0.00025);
            EXPECT_EQ(writer->position_error() > 0, small);
            const Whole back = read_whole(folder / "a.pcd");
            EXPECT_EQ(back.info.position_type, ScalarType::f64);
            expect_same_points(cloud, back);
        }
}

TEST(PcdWriter, FloatPositionsAreRelativeToAShift)
{
    TemporaryFolder folder;
    RandomCloud cloud = on_grid({500000.25, 4800000.5, 12}, 1000000);
    cloud.info.metadata = {metadata("pcd.viewpoint", "1 2 3 0.5 0.5 0.5 0.5")};
    for (const bool ascii : {false, true}) {
        WriteOptions options;
        options.ascii = ascii;
        options.float_positions = true;
        options.survey = survey_of(cloud.info, cloud.points, "pcd", options);
        const auto writer = create_writer(folder / "a.pcd", cloud.info, options);
        writer->write(cloud.points);
        writer->finish();
        EXPECT_TRUE(any_mentions(writer->notes(), "relative to 500000 4800000 0"));
        EXPECT_GT(writer->position_error(), 0);
        EXPECT_LT(writer->position_error(), 0.0001);
        std::string bytes = read_bytes(folder / "a.pcd");
        EXPECT_TRUE(mentions(bytes, "\nVIEWPOINT 500000 4800000 0 1 0 0 0\n"));
        EXPECT_TRUE(mentions(bytes, "SIZE 4 4 4\nTYPE F F F\n"));
        const Whole back = read_whole(folder / "a.pcd");
        EXPECT_TRUE(back.info.notes.empty());
        expect_same_points(cloud, back);
        EXPECT_EQ(back.info.metadata.at(0), cloud.info.metadata[0]);
        EXPECT_EQ(back.info.metadata.size(), 2u) << "that and the grid; the shift is not a viewpoint";
        // Somebody has moved the points, and VIEWPOINT with them.
        bytes.replace(bytes.find("VIEWPOINT 500000"), 16, "VIEWPOINT 600000");
        const Whole moved = read_whole(write_file(folder / "b.pcd", bytes));
        EXPECT_TRUE(any_mentions(moved.info.notes, "VIEWPOINT has another"));
        EXPECT_LT(std::fabs(moved.position(0)[0]), 2000);
    }
}

TEST(PcdWriter, FloatPositionsOfDoublesReportTheirError)
{
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    RandomCloud cloud;
    cloud.points.reset({}, false, 3);
    cloud.points.xyz = {{{40000000.1, 40000001, 40000002}, {0.5, 0.25, -0.5}, {-1e6, -1e6 + 0.1, NAN}}};
    WriteOptions options;
    options.float_positions = true;
    options.survey = survey_of(cloud.info, cloud.points, "pcd", options);
    const auto writer = create_writer(folder / "a.pcd", cloud.info, options);
    writer->write(cloud.points);
    writer->finish();
    const Whole back = read_whole(folder / "a.pcd");
    double error = 0;
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t a = 0; a < 3; ++a)
            error = std::max(error, std::fabs(back.position(i)[a] - cloud.points.xyz[a][i]));
    EXPECT_TRUE(std::isnan(back.position(2)[2]));
    EXPECT_EQ(writer->position_error(), error);
    EXPECT_LT(error, 1e-6);
    EXPECT_GT(error, 0);
    // The shift is a float itself.
    EXPECT_TRUE(mentions(read_bytes(folder / "a.pcd"), "VIEWPOINT 40000000 0 -1000000 1 0 0 0"))
        << read_bytes(folder / "a.pcd").substr(0, 400);
}

}  // namespace
}  // namespace pcm::test
