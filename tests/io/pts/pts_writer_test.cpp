#include "pcm/io/pts/pts_writer.h"

#include "tests/io/text_lines.h"

namespace pcm::test {
namespace {

FileInfo cloud_of(std::initializer_list<Attribute> attributes)
{
    FileInfo cloud;
    for (const Attribute& attribute : attributes) cloud.schema.add(attribute);
    return cloud;
}

const std::string blanks(19, ' ');  // after a count of one digit

PointBatch two_points(const FileInfo& cloud)
{
    PointBatch batch = batch_of(cloud, 2);
    batch.xyz = {{{1, 4}, {2, 5.5}, {3, -6}}};
    return batch;
}

TEST(PtsWriter, PositionsAlone)
{
    const FileInfo cloud = cloud_of({});
    TemporaryFolder folder;
    EXPECT_TRUE(write_cloud(folder / "a.pts", cloud, two_points(cloud)).empty());
    EXPECT_EQ(read_bytes(folder / "a.pts"), "2" + blanks + "\n1 2 3\n4 5.5 -6\n");
}

TEST(PtsWriter, IntensitiesStayAsTheyAre)
{
    const FileInfo cloud = cloud_of({{"intensity", ScalarType::i16}, {"classification", ScalarType::u8}});
    PointBatch batch = two_points(cloud);
    batch.attributes[0].as<std::int16_t>()[0] = -2048;
    batch.attributes[0].as<std::int16_t>()[1] = 2047;
    TemporaryFolder folder;
    auto notes = write_cloud(folder / "a.pts", cloud, batch);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_TRUE(mentions(notes[0], "classification")) << notes[0];
    EXPECT_EQ(read_bytes(folder / "a.pts"), "2" + blanks + "\n1 2 3 -2048\n4 5.5 -6 2047\n");

    batch.attributes[0].as<std::int16_t>()[1] = 2048;
    notes = write_cloud(folder / "a.pts", cloud, batch);
    ASSERT_EQ(notes.size(), 2u);
    EXPECT_TRUE(mentions(notes[1], "1 are not") && mentions(notes[1], "from -2048 to 2048")) << notes[1];
}

TEST(PtsWriter, IntensitiesThatAreFractions)
{
    const FileInfo cloud = cloud_of({{"intensity", ScalarType::f32}});
    PointBatch batch = two_points(cloud);
    batch.attributes[0].as<float>()[0] = 0.1f;
    batch.attributes[0].as<float>()[1] = 1.f;
    TemporaryFolder folder;
    const auto notes = write_cloud(folder / "a.pts", cloud, batch);
    EXPECT_EQ(read_bytes(folder / "a.pts"), "2" + blanks + "\n1 2 3 0.1\n4 5.5 -6 1\n");
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_TRUE(mentions(notes[0], "1 are not")) << notes[0];
}

TEST(PtsWriter, ColoursWithoutIntensities)
{
    const FileInfo cloud = cloud_of({{"rgb", ScalarType::u8, 3}});
    PointBatch batch = two_points(cloud);
    for (std::size_t i = 0; i < 6; ++i) batch.attributes[0].as<std::uint8_t>()[i] = static_cast<std::uint8_t>(51 * i);
    TemporaryFolder folder;
    const auto notes = write_cloud(folder / "a.pts", cloud, batch);
    EXPECT_EQ(read_bytes(folder / "a.pts"), "2" + blanks + "\n1 2 3 0 0 51 102\n4 5.5 -6 0 153 204 255\n");
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_TRUE(mentions(notes[0], "all are written as 0")) << notes[0];
}

// Every 16-bit value against the nearest of 255 steps.
TEST(PtsWriter, ColoursOfSixteenBits)
{
    const FileInfo cloud = cloud_of({{"intensity", ScalarType::u8}, {"rgb", ScalarType::u16, 3}});
    TemporaryFolder folder;
    PointBatch batch = batch_of(cloud, 65536);
    for (std::size_t i = 0; i < 65536; ++i) {
        for (std::size_t k = 0; k < 3; ++k)
            batch.attributes[1].as<std::uint16_t>()[3 * i + k] = static_cast<std::uint16_t>(i);
        batch.attributes[0].as<std::uint8_t>()[i] = 0;
    }
    auto notes = write_cloud(folder / "a.pts", cloud, batch);
    const auto lines = lines_of(folder / "a.pts");
    ASSERT_EQ(lines.size(), 65537u);
    EXPECT_EQ(std::stoul(lines[0]), 65536u);
    for (std::size_t i = 0; i < 65536; ++i) {
        const long nearest = std::lround(static_cast<double>(i) / 257);
        ASSERT_EQ(fields_of(lines[i + 1], ' ')[4], std::to_string(nearest));
    }
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_TRUE(mentions(notes[0], "65,280 points were rounded")) << notes[0];

    for (std::size_t i = 0; i < 3 * 65536; ++i)
        batch.attributes[1].as<std::uint16_t>()[i] = static_cast<std::uint16_t>(257 * (i % 256));
    EXPECT_TRUE(write_cloud(folder / "a.pts", cloud, batch).empty()) << "multiples of 257 are exact";

    for (std::size_t i = 0; i < 3 * 65536; ++i)
        batch.attributes[1].as<std::uint16_t>()[i] = static_cast<std::uint16_t>(i % 256);
    notes = write_cloud(folder / "a.pts", cloud, batch);
    EXPECT_TRUE(any_mentions(notes, "perhaps the source means 0..255"));
}

TEST(PtsWriter, ColoursInFloats)
{
    const FileInfo cloud = cloud_of({{"intensity", ScalarType::u8}, {"rgb", ScalarType::f32, 3}});
    TemporaryFolder folder;
    PointBatch batch = batch_of(cloud, 256);
    for (auto& axis : batch.xyz) std::fill(axis.begin(), axis.end(), 0.0);
    std::memset(batch.attributes[0].data(), 0, batch.attributes[0].bytes());
    for (std::size_t i = 0; i < 256; ++i)
        for (std::size_t k = 0; k < 3; ++k) batch.attributes[1].as<float>()[3 * i + k] = static_cast<float>(i) / 255.f;
    EXPECT_TRUE(write_cloud(folder / "a.pts", cloud, batch).empty()) << "steps of 1/255 are exact";
    const auto lines = lines_of(folder / "a.pts");
    for (std::size_t i = 0; i < 256; ++i) {
        const std::string n = std::to_string(i);
        ASSERT_EQ(lines[i + 1], "0 0 0 0 " + n + " " + n + " " + n);
    }

    float* rgb = batch.attributes[1].as<float>();
    rgb[0] = 0.5f;
    rgb[3] = 1.5f;
    rgb[6] = -1.f;
    rgb[9] = std::numeric_limits<float>::quiet_NaN();
    const auto notes = write_cloud(folder / "a.pts", cloud, batch);
    EXPECT_TRUE(any_mentions(notes, "1 point was rounded"));
    EXPECT_TRUE(any_mentions(notes, "3 points were out of range"));
    const auto cut = lines_of(folder / "a.pts");
    EXPECT_EQ(cut[1], "0 0 0 0 128 0 0");
    EXPECT_EQ(cut[2], "0 0 0 0 255 1 1");
    EXPECT_EQ(cut[3], "0 0 0 0 0 2 2");
    EXPECT_EQ(cut[4], "0 0 0 0 0 3 3");
}

TEST(PtsWriter, AttributesOfAnotherShapeAreNotWritten)
{
    const FileInfo cloud = cloud_of({{"intensity", ScalarType::u8, 2}, {"rgb", ScalarType::u8, 4}});
    TemporaryFolder folder;
    const auto notes = write_cloud(folder / "a.pts", cloud, two_points(cloud));
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_TRUE(mentions(notes[0], "intensity, rgb")) << notes[0];
    EXPECT_EQ(lines_of(folder / "a.pts")[1], "1 2 3");
}

TEST(PtsWriter, NoPoints)
{
    TemporaryFolder folder;
    create_writer(folder / "a.pts", cloud_of({}))->finish();
    EXPECT_EQ(read_bytes(folder / "a.pts"), "0" + blanks + "\n");
}

}  // namespace
}  // namespace pcm::test
