#include "pcm/io/pcd/pcd_writer.h"

#include "tests/io/random_cloud.h"

namespace pcm::test {
namespace {

class PcdWriting : public testing::TestWithParam<bool> {};

TEST_P(PcdWriting, AnyCloudComesBackBitForBit)
{
    const bool ascii = GetParam();
    std::mt19937_64 random(12);
    TemporaryFolder folder;
    for (int round = 0; round < 40; ++round) {
        SCOPED_TRACE(round);
        const std::size_t points = round == 0 ? 0 : 1 + random() % (ascii ? 300 : 9000);
        std::vector<Attribute> attributes = random_attributes(random);
        if (round % 2) {  // what is packed
            for (Attribute& attribute : attributes)
                if (attribute.name == "rgb" || attribute.name == "alpha") attribute.type = ScalarType::u8;
            if (round % 4 == 1) attributes.push_back({"ReturnNumber", ScalarType::u8, 1, 1, 0, {}});
        }
        RandomCloud cloud = random_cloud(random, static_cast<PositionKind>(round % 3), points, !ascii, attributes);
        cloud.info.metadata = {metadata("las.vlr/LASF_Projection/2112", "PROJCS[\"WGS 84 / UTM zone 32N\"]"),
                               metadata("bytes of any kind", std::string("\0\xFF%\n", 4)), metadata("", "")};
        WriteOptions options;
        options.ascii = ascii;
        if (round % 2) options.survey = survey_of(cloud.info, cloud.points, "pcd");
        write_cloud(folder / "a.pcd", cloud, random, options);
        const Whole whole = read_whole(folder / "a.pcd", 1 + random() % 4000);
        EXPECT_TRUE(whole.info.notes.empty()) << whole.info.notes[0];
        EXPECT_EQ(whole.info.format, ascii ? "PCD 0.7 ascii" : "PCD 0.7 binary");
        EXPECT_EQ(whole.info.position_type, round % 3 == 1 ? ScalarType::f32 : ScalarType::f64);
        expect_same_schema(cloud.info.schema, whole.info.schema);
        expect_same_points(cloud, whole);
        if (round % 3 == 0)
            cloud.info.metadata.push_back(metadata("pcm.grid", "0.001 0.01 1e-07 500000.25 -4100000 0.1"));
        cloud.info.metadata.push_back(metadata("pcd.viewpoint", "0 0 0 1 0 0 0"));
        EXPECT_EQ(whole.info.metadata, cloud.info.metadata);
    }
}

INSTANTIATE_TEST_SUITE_P(All, PcdWriting, testing::Bool(),
                         [](const auto& p) { return std::string(p.param ? "ascii" : "binary"); });

TEST(PcdWriter, SampleCloudsSurvive)
{
    PCM_REQUIRE_SAMPLE("crossformat");
    expect_samples_survive(".pcd");
}

RandomCloud one_point(bool with_alpha)
{
    RandomCloud cloud;
    cloud.info.position_type = ScalarType::f32;
    cloud.info.metadata = {metadata("pcd.viewpoint", "1 2 3 0.5 0.5 0.5 0.5")};
    cloud.info.schema.add({"rgb", ScalarType::u8, 3, 1, 0, {}});
    if (with_alpha) cloud.info.schema.add({"alpha", ScalarType::u8, 1, 1, 0, {}});
    cloud.info.schema.add({"normal", ScalarType::f32, 3, 1, 0, {}});
    cloud.info.schema.add({"id", ScalarType::i64, 1, 1, 0, {}});
    cloud.info.schema.add({"odd name", ScalarType::u16, 2, 0.5, -1, {}});
    cloud.points.reset(cloud.info.schema, false, 1);
    cloud.points.xyz = {{{1.5}, {-2}, {0.25}}};
    auto column = cloud.points.attributes.begin();
    for (std::size_t c = 0; c < 3; ++c) column->as<std::uint8_t>()[c] = static_cast<std::uint8_t>(10 + c);
    if (with_alpha) (++column)->as<std::uint8_t>()[0] = 200;
    ++column;
    for (std::size_t c = 0; c < 3; ++c) column->as<float>()[c] = static_cast<float>(c);
    (++column)->as<std::int64_t>()[0] = -2;
    ++column;
    for (std::size_t c = 0; c < 2; ++c) column->as<std::uint16_t>()[c] = static_cast<std::uint16_t>(7 + c);
    return cloud;
}

// The file's bytes, frozen, as other programs read them.
TEST(PcdWriter, BytesOfOnePoint)
{
    const auto header = [](const std::string& colour, const std::string& kind, const std::string& encoding) {
        return "# .PCD v0.7 - Point Cloud Data file format\n"
               "# pcm .......................................\n"
               "# pcm attribute odd_name u16 2 0.5 -1 odd%20name -\n"
               "VERSION 0.7\nFIELDS x y z " +
               colour +
               " normal_x normal_y normal_z id odd_name\n"
               "SIZE 4 4 4 4 4 4 4 8 4\nTYPE F F F " +
               kind +
               " F F F I F\nCOUNT 1 1 1 1 1 1 1 1 2\n"
               "WIDTH 1\nHEIGHT 1\nVIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\nPOINTS 1\nDATA " +
               encoding + "\n";
    };
    const auto binary = [](std::uint32_t colour) {
        Bytes bytes;
        bytes.put(1.5f).put(-2.f).put(.25f).put(colour).put(0.f).put(1.f).put(2.f).put(std::int64_t{-2});
        return bytes.put(2.5f).put(3.f).data;  // 7 and 8, times 0.5, less 1
    };
    std::mt19937_64 random(1);
    TemporaryFolder folder;
    WriteOptions ascii;
    ascii.ascii = true;
    write_cloud(folder / "a.pcd", one_point(false), random);
    EXPECT_EQ(read_bytes(folder / "a.pcd"), header("rgb", "F", "binary") + binary(0x000A0B0C));
    write_cloud(folder / "a.pcd", one_point(false), random, ascii);
    EXPECT_EQ(read_bytes(folder / "a.pcd"), header("rgb", "U", "ascii") + "1.5 -2 0.25 658188 0 1 2 -2 2.5 3\n");
    write_cloud(folder / "a.pcd", one_point(true), random);
    EXPECT_EQ(read_bytes(folder / "a.pcd"), header("rgba", "U", "binary") + binary(0xC80A0B0C));
    write_cloud(folder / "a.pcd", one_point(true), random, ascii);
    EXPECT_EQ(read_bytes(folder / "a.pcd"), header("rgba", "U", "ascii") + "1.5 -2 0.25 3356101388 0 1 2 -2 2.5 3\n");
}

TEST(PcdWriter, NotesWhatOtherProgramsCannotUse)
{
    TemporaryFolder folder;
    FileInfo info;
    info.schema.add({"rgb", ScalarType::u16, 3, 1, 0, {}});
    auto notes = create_pcd(folder / "a.pcd", info, {})->notes();
    EXPECT_TRUE(any_mentions(notes, "F 8")) << notes.size();
    EXPECT_TRUE(any_mentions(notes, "u16")) << notes.size();
    EXPECT_TRUE(create_pcd(folder / "a.pcd", one_point(true).info, {})->notes().empty());
}

TEST(PcdWriter, InvalidViewpoints)
{
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    for (const char* text : {"", "1 2 3", "0 0 0 1 0 0 0 0", "0 0 0 1 0 0 nan", "0 0 0 1 0 0 0\nDATA ascii"}) {
        RandomCloud cloud;
        cloud.info.metadata = {metadata("pcd.viewpoint", text)};
        write_cloud(folder / "a.pcd", cloud, random);
        const std::string bytes = read_bytes(folder / "a.pcd");
        EXPECT_TRUE(mentions(bytes, "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 0\nDATA binary\n")) << bytes;
    }
}

TEST(PcdWriter, RefusesBatchesOfAnotherShapeAndLeavesNothing)
{
    TemporaryFolder folder;
    FileInfo info;
    info.grid = Grid{};
    {
        const auto writer = create_pcd(folder / "a.pcd", info, {});
        PointBatch batch;
        batch.reset(info.schema, false, 2);
        EXPECT_EQ(error_of([&] { writer->write(batch); }).code(), ErrorCode::invalid_argument);
    }
    info.schema.add({"extra_bytes", ScalarType::u8, 17000000, 1, 0, {}});
    EXPECT_EQ(error_of([&] { create_pcd(folder / "a.pcd", info, {}); }).code(), ErrorCode::invalid_argument);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace pcm::test
