// Files of different coordinate systems, units and GPS times do not become one cloud without a word.
#include "pcm/io/pipe/system_check.h"

#include "pcm/io/pipe/merged_reader.h"
#include "tests/io/cloud_copy.h"
#include "tests/io/crs_records.h"

namespace pcm::test {
namespace {

LasFile tile(const std::vector<LasVlr>& vlrs, int format = 0, std::uint16_t encoding = 0, int version = 2)
{
    std::mt19937_64 random(1);
    LasFile file = random_las(random, version, format, 10);
    file.vlrs = vlrs;
    file.encoding = encoding;
    return file;
}

LasVlr keys(int code, int unit = 9001) { return {"LASF_Projection", 34735, geo_projected(code, unit)}; }
LasVlr wkt(int zone) { return {"LASF_Projection", 2112, wkt_utm(zone)}; }

class SystemCheckTest : public testing::Test {
protected:
    std::unique_ptr<MergedReader> merged(const std::vector<LasFile>& files, bool ignore = false)
    {
        std::vector<std::filesystem::path> paths;
        for (std::size_t i = 0; i < files.size(); ++i) {
            const std::string name = std::string(1, static_cast<char>('a' + i)) + ".las";
            paths.push_back(write_file(folder_ / name, files[i].bytes()));
        }
        ReadOptions options;
        options.ignore_crs = ignore;
        return std::make_unique<MergedReader>(paths, options);
    }
    void expect_refused(const std::vector<LasFile>& files, const std::vector<std::string>& words)
    {
        try {
            merged(files);
            FAIL() << words[0];
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            for (const std::string& word : words) EXPECT_TRUE(mentions(error.what(), word)) << error.what();
        }
        // Only when asked to, and then with a note.
        const auto reader = merged(files, true);
        EXPECT_TRUE(any_mentions(reader->info().notes, "the difference is ignored"));
        EXPECT_EQ(records(*reader), 1u);
    }
    static std::size_t records(const PointReader& reader)
    {
        std::size_t count = 0;
        for (const Metadata& block : reader.info().metadata)
            count += is_wkt_record(block) || (is_geotiff_record(block) && mentions(block.key, "34735"));
        return count;
    }
    TemporaryFolder folder_;
};

TEST_F(SystemCheckTest, DifferentSystemsAreRefusedByBothNames)
{
    expect_refused({tile({keys(32632)}), tile({keys(32632)}), tile({keys(32633)})},
                   {"c.las: its coordinate system is EPSG:32633", "a.las has EPSG:32632", "--ignore-crs"});
    expect_refused({tile({keys(32632)}), tile({wkt(33)})}, {"EPSG:32632", "WGS 84 / UTM zone 33N (EPSG:32633)"});
    expect_refused({tile({keys(2229, 9003)}), tile({keys(2229, 9002)})}, {"US survey foot", "foot"});
}

TEST_F(SystemCheckTest, TheFirstSystemIsKeptWhereDifferencesAreIgnored)
{
    const auto reader = merged({tile({}), tile({keys(32632)}), tile({keys(32633)}), tile({wkt(31)})}, true);
    const auto system = coordinate_system_of(reader->info().metadata);
    ASSERT_TRUE(system);
    EXPECT_EQ(system->horizontal.code, 32632u);
    EXPECT_EQ(records(*reader), 1u);
    EXPECT_TRUE(any_mentions(reader->info().notes, "a.las: no coordinate system is stated"));
    EXPECT_TRUE(any_mentions(reader->info().notes, "c.las: its coordinate system is EPSG:32633"));
}

TEST_F(SystemCheckTest, OneSystemInTwoFormsIsKeptOnce)
{
    const auto reader = merged({tile({keys(32632)}), tile({wkt(32)}), tile({keys(32632, 0)}), tile({keys(32632)})});
    EXPECT_EQ(records(*reader), 1u);
    EXPECT_TRUE(reader->info().notes.empty()) << reader->info().notes[0];
}

TEST_F(SystemCheckTest, FilesWithoutASystemAreNoted)
{
    const auto reader = merged({tile({}), tile({wkt(32)}), tile({})});
    EXPECT_TRUE(any_mentions(reader->info().notes,
                             "a.las, c.las: no coordinate system is stated; it is taken to be that of the other files, "
                             "WGS 84 / UTM zone 32N (EPSG:32632), metre"));
    EXPECT_EQ(records(*reader), 1u);
    EXPECT_TRUE(merged({tile({}), tile({})})->info().notes.empty());
}

TEST_F(SystemCheckTest, WhatCannotBeComparedIsNoted)
{
    const LasVlr named{"LASF_Projection", 2112, "PROJCS[\"our plan\",UNIT[\"metre\",1]]"};
    const auto reader = merged({tile({keys(32632)}), tile({named})});
    EXPECT_TRUE(any_mentions(reader->info().notes,
                             "b.las: its coordinate system, our plan, metre, is taken to be that of "
                             "a.las, EPSG:32632, metre"));
    EXPECT_EQ(records(*reader), 1u);
}

TEST_F(SystemCheckTest, RecordsThatNobodyUnderstandsAreKeptUntilThereIsABetterOne)
{
    const LasVlr broken{"LASF_Projection", 2112, "PROJCS[\"cut"};
    const auto alone = merged({tile({broken}), tile({broken, {"LASF_Projection", 2111, "more"}})});
    EXPECT_EQ(records(*alone), 1u);
    EXPECT_TRUE(any_mentions(alone->info().notes, "its coordinate system cannot be decoded"));
    const auto better = merged({tile({broken}), tile({wkt(32)})});
    EXPECT_EQ(records(*better), 1u);
    EXPECT_EQ(coordinate_system_of(better->info().metadata)->horizontal.code, 32632u);
}

TEST_F(SystemCheckTest, GpsTimesOfTwoKindsAreRefused)
{
    expect_refused(
        {tile({keys(32632)}, 1, 0), tile({keys(32632)}, 1, 1)},
        {"b.las: its GPS times are standard GPS time minus 1000 million", "a.las are seconds of the GPS week"});
    // Points without times do not matter.
    EXPECT_TRUE(merged({tile({}, 0, 0), tile({}, 0, 1)})->info().notes.empty());
    EXPECT_EQ(gps_time_of(merged({tile({}, 0, 0), tile({}, 1, 1)})->info().metadata)->offset_in_millions, 1000u);
    // LAS 1.0 and 1.1 have no such bit.
    EXPECT_NO_THROW(merged({tile({}, 1, 1, 1), tile({}, 1, 0)}));
    EXPECT_THROW(merged({tile({}, 1, 1, 1), tile({}, 1, 1)}), Error);
}

// A cloud that has lost its times keeps the header.
TEST_F(SystemCheckTest, GpsTimesCountOnlyWhereThePointsHaveThem)
{
    const auto cloud = [&](std::uint16_t encoding, bool timed) {
        FileInfo info = open_reader(write_file(folder_ / "a.las", tile({}, 1, encoding).bytes()))->info();
        if (!timed) info.schema = {};
        return info;
    };
    SystemCheck check(false);
    check.add(cloud(0, true), "a.las");
    EXPECT_NO_THROW(check.add(cloud(1, false), "b.las"));
    EXPECT_THROW(check.add(cloud(1, true), "c.las"), Error);
}

TEST_F(SystemCheckTest, OffsetsOfLas15AreCompared)
{
    const auto las15 = [](std::uint16_t offset) {
        LasFile file = tile({wkt(32)}, 6, 1 | 16 | 64, 5);
        file.time_offset = offset;
        return file;
    };
    expect_refused({las15(1500), las15(1250)}, {"1500 million seconds", "1250 million seconds"});
    EXPECT_NO_THROW(merged({las15(1000), tile({wkt(32)}, 6, 1 | 16, 4)}));
}

// A merged file states one system, whatever the sources did.
TEST_F(SystemCheckTest, WrittenFilesHaveOneSystemAndTrueBits)
{
    const auto written = [&](const std::vector<LasFile>& files) {
        auto reader = merged(files, true);
        const Whole cloud = read_whole(*reader);
        write_cloud(folder_ / "out.las", cloud);
        return open_reader(folder_ / "out.las");
    };
    // The first header says neither WKT nor standard time.
    const auto reader = written({tile({}, 0, 0, 4), tile({wkt(32)}, 1, 1 | 16, 4)});
    EXPECT_EQ(records(*reader), 1u);
    const auto header = first_las_summary(reader->info().metadata);
    ASSERT_TRUE(header);
    EXPECT_TRUE(header->wkt_bit);
    EXPECT_TRUE(header->global_encoding & 1u) << "standard GPS time";
    // The first has WKT, but the keys of the second are the only record.
    EXPECT_FALSE(
        first_las_summary(written({tile({}, 6, 16, 4), tile({keys(32632)}, 6, 0, 4)})->info().metadata)->wkt_bit);
}

}  // namespace
}  // namespace pcm::test
