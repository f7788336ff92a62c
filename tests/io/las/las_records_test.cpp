// Records of a LAS file on their way into other files: Extra Bytes VLRs, coordinate systems, what has no place.
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/las_summary.h"
#include "tests/io/cloud_copy.h"
#include "tests/io/crs_records.h"

namespace pcm::test {
namespace {

LasFile with_extra_bytes(std::size_t bytes, const std::vector<std::string>& descriptions)
{
    std::mt19937_64 random(5);
    LasFile file = random_las(random, 4, 6, 50, bytes);
    for (const std::string& description : descriptions) file.vlrs.push_back({"LASF_Spec", 4, description});
    return file;
}

// An attribute has one scale and one offset: components that differ in either become attributes of their own.
TEST(LasRecords, ComponentsWithOtherOffsetsOrScalesAreSeparate)
{
    TemporaryFolder folder;
    using Three = std::array<double, 3>;
    for (const auto& [scale, offset] : {std::pair<Three, Three>{{0.5, 0.5, 0.5}, {1, 2, 3}},
                                        {{0.5, 0.5, 0.5}, {1, 1, 3}},
                                        {{0.5, 0.5, 0.25}, {1, 1, 1}}}) {
        const LasFile file = with_extra_bytes(6, {extra_descriptor(23, 0x18, "v", scale, offset)});
        const Whole cloud = read_whole(write_file(folder / "a.las", file.bytes()));
        for (std::size_t c = 0; c < 3; ++c) {
            const auto slot = cloud.info.schema.find("v[" + std::to_string(c) + "]");
            ASSERT_TRUE(slot) << c;
            EXPECT_EQ(cloud.info.schema[*slot].scale, scale[c]);
            EXPECT_EQ(cloud.info.schema[*slot].offset, offset[c]);
            EXPECT_EQ(cloud.info.schema[*slot].components, 1u);
        }
        write_cloud(folder / "b.las", cloud);
        expect_same_cloud(cloud, read_whole(folder / "b.las"));
    }
    const LasFile alike = with_extra_bytes(6, {extra_descriptor(23, 0x18, "v", {2, 2, 2}, {5, 5, 5})});
    const Whole cloud = read_whole(write_file(folder / "a.las", alike.bytes()));
    ASSERT_TRUE(cloud.info.schema.find("v"));
    EXPECT_EQ(cloud.info.schema[*cloud.info.schema.find("v")].components, 3u);
}

TEST(LasRecords, SeveralExtraBytesVlrsAreReadTogether)
{
    TemporaryFolder folder;
    std::string second = extra_descriptor(4, 0x1C, "b", {0.5, 0, 0}, {3, 0, 0});
    second[40] = 'n';  // its "no data" value is kept too
    const LasFile file = with_extra_bytes(4, {extra_descriptor(3, 0, "a"), second});
    const Whole cloud = read_whole(write_file(folder / "a.las", file.bytes()));
    ASSERT_TRUE(cloud.info.schema.find("a"));
    ASSERT_TRUE(cloud.info.schema.find("b"));
    EXPECT_EQ(cloud.info.schema[*cloud.info.schema.find("b")].scale, 0.5);
    EXPECT_FALSE(cloud.info.schema.find("extra_bytes"));
    EXPECT_TRUE(any_mentions(cloud.info.notes, "2 Extra Bytes VLRs"));

    // One VLR with both descriptions is written.
    write_cloud(folder / "b.las", cloud);
    const Whole copy = read_whole(folder / "b.las");
    expect_same_cloud(cloud, copy);
    EXPECT_TRUE(copy.info.notes.empty());
    std::size_t found = 0;
    for (const Metadata& block : copy.info.metadata)
        if (mentions(block.key, "LASF_Spec/4")) {
            ++found;
            ASSERT_EQ(block.value.size(), 384u);
            EXPECT_EQ(block.value[192 + 40], std::byte{'n'});
        }
    EXPECT_EQ(found, 1u);
}

TEST(LasRecords, ExtraBytesVlrsThatDoNotFitAreNoted)
{
    TemporaryFolder folder;
    const std::string a = extra_descriptor(3, 0, "a");
    const Whole twice = read_whole(write_file(folder / "a.las", with_extra_bytes(2, {a, a}).bytes()));
    EXPECT_TRUE(twice.info.schema.find("a"));
    EXPECT_TRUE(any_mentions(twice.info.notes, "they are equal"));
    const Whole more =
        read_whole(write_file(folder / "a.las", with_extra_bytes(2, {a, extra_descriptor(4, 0, "b")}).bytes()));
    EXPECT_TRUE(more.info.schema.find("a"));
    EXPECT_FALSE(more.info.schema.find("b"));
    EXPECT_TRUE(any_mentions(more.info.notes, "only the first is used"));
}

TEST(LasRecords, WktOfOtherFormatsBecomesARecord)
{
    TemporaryFolder folder;
    std::mt19937_64 random(6);
    Whole cloud = read_whole(write_file(folder / "a.las", random_las(random, 2, 1, 20).bytes()));
    cloud.info.metadata = {block("e57.coordinateMetadata", wkt_utm(33)), block("e57.xml", "<e57Root/>")};
    const Written written = write_cloud(folder / "b.las", cloud);
    EXPECT_TRUE(any_mentions(written.notes, "e57.xml"));
    EXPECT_FALSE(any_mentions(written.notes, "e57.coordinateMetadata"));
    const FileInfo info = open_reader(folder / "b.las")->info();
    const auto system = coordinate_system_of(info.metadata);
    ASSERT_TRUE(system);
    EXPECT_EQ(system->horizontal.code, 32633u);
    EXPECT_EQ(system->source, "WKT");
    EXPECT_TRUE(first_las_summary(info.metadata)->wkt_bit);

    cloud.info.metadata = {block("crs", "EPSG:32633 WGS 84 / UTM zone 33N")};
    EXPECT_TRUE(any_mentions(write_cloud(folder / "b.las", cloud).notes, "EPSG:32633"));
    cloud.info.metadata.clear();
    EXPECT_TRUE(write_cloud(folder / "b.las", cloud).notes.empty());
}

TEST(LasRecords, TextHasTheSystemAsACommentAndNamesWhatItLacks)
{
    TemporaryFolder folder;
    std::mt19937_64 random(7);
    LasFile file = random_las(random, 2, 0, 20);
    file.vlrs = {{"LASF_Projection", 2112, wkt_utm(32)}, {"someone", 7, "data"}};
    const Whole cloud = read_whole(write_file(folder / "a.las", file.bytes()));
    for (const char* extension : {"xyz", "txt", "asc", "csv", "pts"}) {
        const auto path = folder / (std::string("b.") + extension);
        const Written written = write_cloud(path, cloud);
        EXPECT_TRUE(any_mentions(written.notes, "someone/7")) << extension;
        EXPECT_FALSE(any_mentions(written.notes, "las.header")) << extension;
        const bool comment = extension[0] != 'c' && extension[0] != 'p';
        EXPECT_EQ(mentions(read_bytes(path), "\n# crs: EPSG:32632 WGS 84 / UTM zone 32N\n"), comment) << extension;
        EXPECT_EQ(any_mentions(written.notes, "no place for the coordinate system"), !comment) << extension;
        const auto reader = open_reader(path);
        const auto system = coordinate_system_of(reader->info().metadata);
        EXPECT_EQ(system.has_value(), comment) << extension;
        if (comment) {
            EXPECT_EQ(system->horizontal.code, 32632u);
        }
        EXPECT_EQ(read_whole(*reader).points.size, 20u) << extension;
    }
    for (const char* extension : {"ply", "pcd"}) {
        const auto path = folder / (std::string("b.") + extension);
        write_cloud(path, cloud);
        const std::string mark = extension[1] == 'l' ? "\ncomment " : "\n# ";
        EXPECT_TRUE(mentions(read_bytes(path), mark + "crs: EPSG:32632 WGS 84 / UTM zone 32N\n")) << extension;
        EXPECT_EQ(coordinate_system_of(open_reader(path)->info().metadata)->wkt, wkt_utm(32));
    }
    // Clouds without metadata get neither.
    Whole plain = cloud;
    plain.info.metadata.clear();
    EXPECT_TRUE(write_cloud(folder / "c.xyz", plain).notes.empty());
    EXPECT_FALSE(mentions(read_bytes(folder / "c.xyz"), "crs"));
}

}  // namespace
}  // namespace pcm::test
