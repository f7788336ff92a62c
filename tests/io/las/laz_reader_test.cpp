// LAZ: the same points as the LAS file it was made from, and damage that is reported.
#include "tests/io/cloud_copy.h"
#include "tests/io/las_file.h"

#include <algorithm>

namespace pcm::test {
namespace {

TEST(Laz, WithoutDecodersTheMessageSaysHowToGetThem)
{
    if (have_laz()) GTEST_SKIP() << "this build has LAZ";
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    Bytes bytes;
    bytes.raw(random_las(random, 2, 3, 1).bytes());
    bytes.overwrite(104, std::uint8_t{0x80 | 3});
    const Error error = error_of([&] { open_reader(write_file(folder / "a.laz", bytes.data)); });
    for (const char* part : {"LAZ", "point format 3", "cargo"})
        EXPECT_TRUE(mentions(error.what(), part)) << error.what();
}

TEST(Laz, AWordInTheHeaderAloneIsNoCompression)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    Bytes bytes;
    bytes.raw(random_las(random, 2, 3, 1).bytes());
    bytes.overwrite(104, std::uint8_t{0x80 | 3});
    const Error error = error_of([&] { open_reader(write_file(folder / "a.laz", bytes.data)); });
    EXPECT_EQ(error.code(), ErrorCode::bad_format);
    EXPECT_TRUE(mentions(error.what(), "laszip encoded")) << error.what();
}

// Files compressed by LASzip and others, compared with the original.
TEST(Laz, SamplesEqualTheirUncompressedTwins)
{
    PCM_REQUIRE_LAZ();
    PCM_REQUIRE_SAMPLE("las/simple.laz");
    std::size_t twins = 0;
    for (const char* folder : {"las", "crossformat"})
        for (const auto& entry : std::filesystem::directory_iterator(sample(folder))) {
            if (entry.path().extension() != ".laz") continue;
            std::filesystem::path twin = entry.path();
            if (!std::filesystem::exists(twin.replace_extension(".las"))) continue;
            SCOPED_TRACE(entry.path().filename());
            ++twins;
            const Whole las = read_whole(twin), laz = read_whole(entry.path(), 777);
            expect_same_cloud(las, laz);
            EXPECT_EQ(without_header(las.info), without_header(laz.info));
            EXPECT_EQ(las.info.promised_box, laz.info.promised_box);
            EXPECT_TRUE(mentions(laz.info.format, "LAZ")) << laz.info.format;
        }
    EXPECT_GE(twins, 8u);
}

TEST(Laz, SamplesAreTheSameWithAnyNumberOfThreads)
{
    PCM_REQUIRE_LAZ();
    PCM_REQUIRE_SAMPLE("las/autzen_trim.laz");
    for (const char* name : {"las/autzen_trim.laz", "las/1.2-with-color.copc.laz", "las/pdrf10-1.4.laz"}) {
        SCOPED_TRACE(name);
        ReadOptions options;
        const Whole one = read_whole(*open_reader(sample(name), options), 4321);
        for (const unsigned threads : {2u, 4u, 7u, 0u}) {
            options.threads = threads;
            expect_same_cloud(one, read_whole(*open_reader(sample(name), options), 10000));
        }
    }
}

TEST(Laz, AReaderThatIsLeftEarlyEndsItsThreads)
{
    PCM_REQUIRE_LAZ();
    PCM_REQUIRE_SAMPLE("las/autzen_trim.laz");
    ReadOptions options;
    options.threads = 3;
    for (int i = 0; i < 4; ++i) {
        const auto reader = open_reader(sample("las/autzen_trim.laz"), options);
        EXPECT_FALSE(reader->seekable());
        PointBatch batch;
        for (int k = 0; k < i; ++k) ASSERT_TRUE(reader->read(batch, 10));
    }
}

TEST(Laz, BrokenSamplesAreRefused)
{
    PCM_REQUIRE_LAZ();
    PCM_REQUIRE_SAMPLE("bad/broken_coder.laz");
    for (const char* name : {"bad/broken_coder.laz", "bad/broken_size.laz"}) {
        const Error error = error_of([&] { read_whole(sample(name)); });
        EXPECT_NE(error.code(), ErrorCode::io) << error.what();
    }
}

}  // namespace
}  // namespace pcm::test
