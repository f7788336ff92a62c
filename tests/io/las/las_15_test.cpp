// LAS 1.5: a header of 393 bytes, with the range of GPS times and their offset.
#include "pcm/io/las_summary.h"
#include "tests/io/cloud_copy.h"
#include "tests/io/crs_records.h"

namespace pcm::test {
namespace {

LasFile las15(int format, std::uint16_t offset)
{
    std::mt19937_64 random(static_cast<std::uint64_t>(format));
    LasFile file = random_las(random, 5, format, 100);
    for (LasRecord& record : file.records) record.gps_time = static_cast<double>(random() % 1000000) * 0.25;
    file.vlrs = {{"LASF_Projection", 2112, wkt_utm(32)}};
    file.encoding = 1 | 16 | 64;
    file.least_time = 0.25;
    file.most_time = 250000;
    file.time_offset = offset;
    file.legacy_count = false;
    return file;
}

TEST(Las15, PointsAndHeaderAreRead)
{
    TemporaryFolder folder;
    for (int format = 6; format <= 10; ++format) {
        const LasFile file = las15(format, 1500);
        const Whole cloud = read_whole(write_file(folder / "a.las", file.bytes()));
        EXPECT_EQ(cloud.info.format, "LAS 1.5, point format " + std::to_string(format));
        EXPECT_TRUE(cloud.info.notes.empty());
        ASSERT_EQ(cloud.points.size, file.records.size());
        for (std::size_t i = 0; i < file.records.size(); ++i) {
            ASSERT_EQ(cloud.points.grid_xyz[2][i], file.records[i].z);
            ASSERT_EQ(cloud.raw<double>("gps_time", i), file.records[i].gps_time);
        }
        const auto header = first_las_summary(cloud.info.metadata);
        ASSERT_TRUE(header);
        EXPECT_EQ(header->version_minor, 5u);
        EXPECT_EQ(header->header_bytes, 393u);
        EXPECT_EQ(header->gps_time->offset_in_millions, 1500u);
        EXPECT_EQ(header->gps_box, (std::array<double, 2>{0.25, 250000}));
        EXPECT_TRUE(header->wkt_bit);
    }
}

TEST(Las15, TheFlagDecidesWhetherTheOffsetCounts)
{
    const auto time_of = [](std::uint16_t encoding) {
        LasFile file = las15(6, 1500);
        file.encoding = encoding;
        return gps_time_of({block("las.header", file.bytes().substr(0, 393))})->offset_in_millions;
    };
    EXPECT_EQ(time_of(1 | 64), 1500u);
    EXPECT_EQ(time_of(1), 1000u);
    EXPECT_EQ(time_of(64), std::nullopt) << "week time";
    EXPECT_EQ(time_of(0), std::nullopt);
}

TEST(Las15, EveryTruncationOfTheHeaderIsRefused)
{
    TemporaryFolder folder;
    const std::string bytes = las15(6, 1500).bytes();
    for (std::size_t size = 0; size < 393; ++size)
        EXPECT_THROW(open_reader(write_file(folder / "a.las", bytes.substr(0, size))), Error) << size;
    Bytes small;
    small.raw(bytes);
    small.overwrite(94, std::uint16_t{375});  // the header of LAS 1.4
    try {
        open_reader(write_file(folder / "a.las", small.data));
        FAIL();
    } catch (const Error& error) {
        EXPECT_TRUE(mentions(error.what(), "LAS 1.5 has at least 393")) << error.what();
    }
    small.overwrite(25, std::uint8_t{6});
    EXPECT_THROW(open_reader(write_file(folder / "a.las", small.data)), Error) << "LAS 1.6";
}

TEST(Las15, OldPointFormatsAreNoted)
{
    TemporaryFolder folder;
    LasFile file = las15(6, 1500);
    file.format = 1;
    const Whole cloud = read_whole(write_file(folder / "a.las", file.bytes()));
    EXPECT_EQ(cloud.points.size, 100u);
    EXPECT_TRUE(any_mentions(cloud.info.notes, "point format 1 is not part of LAS 1.5"));
}

// LAS 1.4 has one offset: the times are moved to it, and a note reports it.
TEST(Las15, WrittenAsLas14TheTimesKeepTheirMeaning)
{
    TemporaryFolder folder;
    for (const int offset : {1000, 1500}) {
        const Whole cloud =
            read_whole(write_file(folder / "a.las", las15(6, static_cast<std::uint16_t>(offset)).bytes()));
        const Written written = write_cloud(folder / "b.las", cloud);
        EXPECT_EQ(any_mentions(written.notes, "seconds are added to the GPS times"), offset != 1000);
        const Whole copy = read_whole(folder / "b.las");
        const auto header = first_las_summary(copy.info.metadata);
        EXPECT_EQ(header->global_encoding, 1u | 16u) << "the flag of LAS 1.5 is not part of LAS 1.4";
        EXPECT_EQ(header->gps_time->offset_in_millions, 1000u);
        for (std::size_t i = 0; i < cloud.points.size; ++i)
            ASSERT_EQ(copy.raw<double>("gps_time", i), cloud.raw<double>("gps_time", i) + (offset - 1000) * 1e6);
    }
}

}  // namespace
}  // namespace pcm::test
