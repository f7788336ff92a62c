#include "pcm/io/ply/ply_writer.h"

#include "tests/io/random_cloud.h"

namespace pcm::test {
namespace {

class PlyWriting : public testing::TestWithParam<bool> {};

TEST_P(PlyWriting, AnyCloudComesBackBitForBit)
{
    const bool ascii = GetParam();
    std::mt19937_64 random(11);
    TemporaryFolder folder;
    for (int round = 0; round < 30; ++round) {
        SCOPED_TRACE(round);
        const std::size_t points = round == 0 ? 0 : 1 + random() % (ascii ? 300 : 9000);
        RandomCloud cloud =
            random_cloud(random, static_cast<PositionKind>(round % 3), points, !ascii, random_attributes(random));
        cloud.info.metadata = {metadata("las.vlr/LASF_Projection/2112", "PROJCS[\"WGS 84 / UTM zone 32N\"]"),
                               metadata("bytes of any kind", std::string("\0\xFF%\n", 4)), metadata("", "")};
        WriteOptions options;
        options.ascii = ascii;
        if (round % 2) options.survey = survey_of(cloud.info, cloud.points, "ply");
        write_cloud(folder / "a.ply", cloud, random, options);
        const Whole whole = read_whole(folder / "a.ply", 1 + random() % 4000);
        EXPECT_TRUE(whole.info.notes.empty()) << whole.info.notes[0];
        EXPECT_EQ(whole.info.format, ascii ? "PLY ascii" : "PLY binary little endian");
        EXPECT_EQ(whole.info.position_type, round % 3 == 1 ? ScalarType::f32 : ScalarType::f64);
        expect_same_schema(cloud.info.schema, whole.info.schema);
        expect_same_points(cloud, whole);
        if (round % 3 == 0)
            cloud.info.metadata.push_back(metadata("pcm.grid", "0.001 0.01 1e-07 500000.25 -4100000 0.1"));
        EXPECT_EQ(whole.info.metadata, cloud.info.metadata);
    }
}

INSTANTIATE_TEST_SUITE_P(All, PlyWriting, testing::Bool(),
                         [](const auto& p) { return std::string(p.param ? "ascii" : "binary"); });

TEST(PlyWriter, SampleCloudsSurvive)
{
    PCM_REQUIRE_SAMPLE("crossformat");
    expect_samples_survive(".ply");
}

// The file's bytes, frozen, as other programs read them.
TEST(PlyWriter, BytesOfOnePoint)
{
    RandomCloud cloud;
    cloud.info.position_type = ScalarType::f32;
    cloud.info.schema.add({"rgb", ScalarType::u8, 3, 1, 0, {}});
    cloud.info.schema.add({"intensity", ScalarType::u16, 1, 1, 0, {}});
    cloud.info.schema.add({"normal", ScalarType::f32, 3, 1, 0, {}});
    cloud.info.schema.add({"id", ScalarType::i64, 1, 1, 0, {}});
    cloud.info.schema.add({"odd name", ScalarType::u8, 2, 0.5, -1, {}});
    cloud.points.reset(cloud.info.schema, false, 1);
    cloud.points.xyz = {{{1.5}, {-2}, {0.25}}};
    for (std::uint8_t c = 0; c < 3; ++c) {
        cloud.points.attributes[0].as<std::uint8_t>()[c] = static_cast<std::uint8_t>(10 + c);
        cloud.points.attributes[2].as<float>()[c] = static_cast<float>(c);
    }
    cloud.points.attributes[1].as<std::uint16_t>()[0] = 513;
    cloud.points.attributes[3].as<std::int64_t>()[0] = -2;
    cloud.points.attributes[4].as<std::uint8_t>()[0] = 7;
    cloud.points.attributes[4].as<std::uint8_t>()[1] = 8;

    const std::string header =
        "comment pcm ...................\n"
        "comment pcm attribute id_low i64 1 1 0 id -\n"
        "comment pcm attribute odd_name_0 u8 2 0.5 -1 odd%20name -\n"
        "element vertex 1\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property ushort intensity\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "property uint id_low\nproperty int id_high\n"
        "property float odd_name_0\nproperty float odd_name_1\n"
        "end_header\n";
    Bytes binary;
    binary.raw("ply\nformat binary_little_endian 1.0\n" + header);
    binary.put(1.5f).put(-2.f).put(.25f).put(std::uint8_t{10}).put(std::uint8_t{11}).put(std::uint8_t{12});
    binary.put(std::uint16_t{513}).put(0.f).put(1.f).put(2.f).put(std::int64_t{-2});
    binary.put(2.5f).put(3.f);  // 7 and 8, times 0.5, less 1

    std::mt19937_64 random(1);
    TemporaryFolder folder;
    write_cloud(folder / "a.ply", cloud, random);
    EXPECT_EQ(read_bytes(folder / "a.ply"), binary.data);
    WriteOptions options;
    options.ascii = true;
    write_cloud(folder / "b.ply", cloud, random, options);
    EXPECT_EQ(read_bytes(folder / "b.ply"),
              "ply\nformat ascii 1.0\n" + header + "1.5 -2 0.25 10 11 12 513 0 1 2 4294967294 -1 2.5 3\n");
}

TEST(PlyWriter, ErrorOfDecimalsAndOfSinglePrecisionIsReported)
{
    TemporaryFolder folder;
    FileInfo info;
    PointBatch batch;
    batch.reset(info.schema, false, 2);
    batch.xyz = {{{0.125, 4.1e6 + 0.375}, {1, std::numeric_limits<double>::quiet_NaN()}, {-7, 1e300}}};
    WriteOptions options;
    options.ascii = true;
    options.decimals = 2;
    auto writer = create_ply(folder / "a.ply", info, options);
    writer->write(batch);
    writer->finish();
    EXPECT_NEAR(writer->position_error(), 0.005, 1e-9);
    const Whole whole = read_whole(folder / "a.ply");
    EXPECT_EQ(whole.position(0), (Vec3d{0.12, 1, -7}));
    EXPECT_EQ(whole.position(1)[2], 1e300);
    EXPECT_TRUE(std::isnan(whole.position(1)[1]));

    info.position_type = ScalarType::f32;
    batch.xyz[2][1] = 0;
    writer = create_ply(folder / "b.ply", info, {});
    writer->write(batch);
    EXPECT_EQ(writer->position_error(), 0.125);
}

TEST(PlyWriter, MetadataThatAreTooLargeAreNamed)
{
    RandomCloud cloud;
    cloud.info.metadata = {metadata("las.evlr/waves/1", std::string(300000, 'x')),
                           metadata("las.vlr/LASF_Projection/2112", std::string(20000, 'y'))};
    std::mt19937_64 random(1);
    TemporaryFolder folder;
    const auto notes = write_cloud(folder / "a.ply", cloud, random);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_TRUE(mentions(notes[0], "las.evlr/waves/1") && mentions(notes[0], "300000")) << notes[0];
    const FileInfo info = open_reader(folder / "a.ply")->info();
    ASSERT_EQ(info.metadata.size(), 1u);
    EXPECT_EQ(info.metadata[0], cloud.info.metadata[1]);
    // Fixed buffers for lines of 512 bytes are common.
    std::ifstream file(folder / "a.ply");
    for (std::string line; std::getline(file, line);) ASSERT_LT(line.size(), 128u);
}

TEST(PlyWriter, RefusesBatchesOfAnotherShape)
{
    TemporaryFolder folder;
    FileInfo info;
    info.schema.add({"intensity", ScalarType::u16, 1, 1, 0, {}});
    const auto writer = create_ply(folder / "a.ply", info, {});
    PointBatch batch;
    batch.reset(info.schema, true, 2);
    EXPECT_EQ(error_of([&] { writer->write(batch); }).code(), ErrorCode::invalid_argument);
    batch.reset({}, false, 2);
    EXPECT_EQ(error_of([&] { writer->write(batch); }).code(), ErrorCode::invalid_argument);
    Schema other;
    other.add({"intensity", ScalarType::i16, 1, 1, 0, {}});
    batch.reset(other, false, 2);
    EXPECT_EQ(error_of([&] { writer->write(batch); }).code(), ErrorCode::invalid_argument);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.ply"));
}

TEST(PlyWriter, RefusesAttributesBeyondAnyHeader)
{
    TemporaryFolder folder;
    for (const std::uint32_t components : {60000u, 4000000000u}) {
        FileInfo info;
        info.schema.add({"extra_bytes", ScalarType::u8, components, 1, 0, {}});
        const Error error = error_of([&] { create_ply(folder / "a.ply", info, {}); });
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_TRUE(mentions(error.what(), "a.ply")) << error.what();
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(PlyWriter, LeavesNothingBehindWithoutFinish)
{
    TemporaryFolder folder;
    std::mt19937_64 random(5);
    const RandomCloud cloud = random_cloud(random, PositionKind::double_precision, 200000, true, {});
    create_ply(folder / "a.ply", cloud.info, {})->write(cloud.points);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// Comments are checked like everything else.
TEST(PlyReader, CommentsThatAreNotTrue)
{
    const auto read = [](const std::string& comments) {
        TemporaryFolder folder;
        return read_whole(write_file(folder / "a.ply",
                                     "ply\nformat ascii 1.0\n" + comments +
                                         "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                                         "property uchar a_0\nproperty uchar a_1\nproperty uchar red\nproperty uchar "
                                         "green\nproperty uchar blue\nend_header\n1 2 3 4 5 6 7 8\n"));
    };
    const Whole good = read("comment pcm attribute a_0 u8 2 1 0 pair -\n");
    EXPECT_EQ(good.value("pair", 0, 1), 5);
    EXPECT_TRUE(good.info.notes.empty());
    for (const char* line :
         {"a_0 u8 9 1 0 pair -", "a_0 u16 2 1 0 pair -", "a_0 i64 1 1 0 pair -", "z u8 1 1 0 pair -",
          "b u8 1 1 0 pair -", "a_0 u8 0 1 0 pair -", "a_0 u8 2 nan 0 pair -", "a_0 u8 2 1 inf pair -",
          "a_0 u8 2 1 0 %zz -", "a_0 u8 2 1 0", "a_0 u8 4294967295 1 0 pair -", "a_0 u7 2 1 0 pair -", ""}) {
        const Whole whole = read(std::string("comment pcm attribute ") + line + "\n");
        EXPECT_EQ(whole.info.schema.size(), 3u) << line;
        EXPECT_EQ(whole.info.notes.size(), 1u) << line;
        EXPECT_EQ(whole.value("rgb", 0, 2), 8) << line;
        EXPECT_EQ(whole.value("a_1", 0), 5) << line;
    }
    // A colour's name for another attribute, in both orders; one property in two attributes.
    EXPECT_EQ(read("comment pcm attribute a_0 u8 2 1 0 rgb -\n").value("rgb_scalar", 0, 1), 5);
    EXPECT_EQ(read("comment pcm attribute a_0 u8 2 1 0 rgb -\n").value("rgb", 0, 1), 7);
    const Whole twice = read("comment pcm attribute a_0 u8 2 1 0 p -\ncomment pcm attribute a_1 u8 1 1 0 q -\n");
    EXPECT_EQ(twice.info.schema.size(), 2u);
    const Whole colour = read("comment pcm attribute red u8 3 0.5 1 rgb -\n");
    EXPECT_EQ(colour.info.schema[*colour.info.schema.find("rgb")].scale, 0.5);
    for (const char* line : {"metadata k 3\ncomment pcm data !!!!", "metadata k 4\ncomment pcm data YWJj", "data YWJj",
                             "metadata", "metadata %4 0"})
        EXPECT_EQ(read(std::string("comment pcm ") + line + "\n").info.metadata.size(), 0u) << line;
    EXPECT_EQ(read("comment pcm metadata k 3\ncomment pcm data YWJj\n").info.metadata.at(0), metadata("k", "abc"));
}

}  // namespace
}  // namespace pcm::test
