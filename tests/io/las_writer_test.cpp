#include "io/las_writer.h"

#include "bytes.h"

#include <sys/resource.h>

#include <csignal>

namespace pcm::test {
namespace {

const Grid grid{{0.001, 0.002, 0.5}, {5e6, -3e6, 100}};

std::vector<LasPoint> random_points(std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::vector<LasPoint> points(count);
    for (LasPoint& p : points) {
        p.x = static_cast<std::int32_t>(random());
        p.y = static_cast<std::int32_t>(random() % 100000) - 70000;
        p.z = static_cast<std::int32_t>(random() % 1000) + 5;
        p.intensity = static_cast<std::uint16_t>(random());
        p.classification = static_cast<std::uint8_t>(random() % 32);
        p.source_id = static_cast<std::uint16_t>(random());
        p.red = static_cast<std::uint16_t>(random());
        p.green = static_cast<std::uint16_t>(random());
        p.blue = static_cast<std::uint16_t>(random());
    }
    return points;
}

std::size_t files_in(const std::filesystem::path& folder)
{
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(LasWriter, WhatIsWrittenIsRead)
{
    TemporaryFolder folder;
    const std::vector<LasPoint> points = random_points(150000, 1);  // some buffers full
    {
        LasWriter writer(folder / "a.las", grid);
        std::mt19937_64 random(2);
        for (std::size_t done = 0; done < points.size();) {
            const std::size_t now = std::min<std::size_t>(random() % 50000, points.size() - done);
            writer.write(points.data() + done, now);
            done += now;
        }
        EXPECT_FALSE(std::filesystem::exists(folder / "a.las")) << "not before finish()";
        writer.finish();
    }
    EXPECT_EQ(files_in(folder.path()), 1u);
    EXPECT_EQ(std::filesystem::file_size(folder / "a.las"), 227 + 26 * points.size());

    const Whole whole = read_whole(folder / "a.las");
    EXPECT_EQ(whole.info.format, "LAS 1.2, point format 2");
    EXPECT_EQ(*whole.info.grid, grid);
    EXPECT_TRUE(whole.info.notes.empty());
    ASSERT_EQ(whole.points.size, points.size());
    Box3d box;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const LasPoint& p = points[i];
        ASSERT_EQ(whole.points.grid_xyz[0][i], p.x);
        ASSERT_EQ(whole.points.grid_xyz[1][i], p.y);
        ASSERT_EQ(whole.points.grid_xyz[2][i], p.z);
        ASSERT_EQ(whole.raw<std::uint16_t>("intensity", i), p.intensity);
        ASSERT_EQ(whole.raw<std::uint8_t>("classification", i), p.classification);
        ASSERT_EQ(whole.raw<std::uint8_t>("return_number", i), 1);
        ASSERT_EQ(whole.raw<std::uint8_t>("number_of_returns", i), 1);
        ASSERT_EQ(whole.raw<std::uint16_t>("point_source_id", i), p.source_id);
        ASSERT_EQ(whole.raw<std::uint16_t>("rgb", i, 0), p.red);
        ASSERT_EQ(whole.raw<std::uint16_t>("rgb", i, 1), p.green);
        ASSERT_EQ(whole.raw<std::uint16_t>("rgb", i, 2), p.blue);
        box.extend(whole.position(i));
    }
    EXPECT_EQ(*whole.info.promised_box, box) << "exact, not rounded";
}

// The header's bytes, frozen.
TEST(LasWriter, HeaderOfOnePoint)
{
    TemporaryFolder folder;
    LasWriter writer(folder / "a.las", Grid{{1, 1, 1}, {0, 0, 0}});
    LasPoint p;
    p.x = 1, p.y = 2, p.z = 3, p.intensity = 0x0405, p.classification = 6, p.source_id = 0x0708;
    p.red = 0x090A, p.green = 0x0B0C, p.blue = 0x0D0E;
    writer.write(&p, 1);
    writer.finish();

    Bytes expected;
    expected.raw("LASF")
        .put(0u)
        .text("", 16)
        .put(std::uint8_t{1})
        .put(std::uint8_t{2})
        .text("OTHER", 32)
        .text("pcm", 32);
    expected.put(std::uint16_t{1}).put(std::uint16_t{2025}).put(std::uint16_t{227}).put(227u).put(0u);
    expected.put(std::uint8_t{2}).put(std::uint16_t{26}).put(1u).put(1u).put(0u).put(0u).put(0u).put(0u);
    for (const double value : {1., 1., 1., 0., 0., 0., 1., 1., 2., 2., 3., 3.}) expected.put(value);
    expected.put(1)
        .put(2)
        .put(3)
        .put(std::uint16_t{0x0405})
        .put(std::uint8_t{9})
        .put(std::uint8_t{6})
        .put(std::uint16_t{0});
    expected.put(std::uint16_t{0x0708})
        .put(std::uint16_t{0x090A})
        .put(std::uint16_t{0x0B0C})
        .put(std::uint16_t{0x0D0E});
    EXPECT_EQ(read_bytes(folder / "a.las"), expected.data);
}

TEST(LasWriter, NoPoints)
{
    TemporaryFolder folder;
    LasWriter writer(folder / "a.las", grid);
    writer.finish();
    EXPECT_EQ(read_whole(folder / "a.las").points.size, 0u);
}

TEST(LasWriter, LeavesNothingBehindWithoutFinish)
{
    TemporaryFolder folder;
    write_file(folder / "a.las", "the old file");
    {
        LasWriter writer(folder / "a.las", grid);
        const auto points = random_points(100000, 3);
        writer.write(points.data(), points.size());
        EXPECT_EQ(files_in(folder.path()), 2u);
    }
    EXPECT_EQ(files_in(folder.path()), 1u);
    EXPECT_EQ(read_bytes(folder / "a.las"), "the old file");
}

TEST(LasWriter, RefusesMoreThanLas12CanCount)
{
    TemporaryFolder folder;
    LasWriter writer(folder / "a.las", grid);
    LasPoint p;
    writer.write(&p, 1);
    // The count is looked at before the points.
    const Error error = error_of([&] { writer.write(&p, 4294967295u); });
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_TRUE(mentions(error.what(), "LAS 1.2") && mentions(error.what(), "4294967295")) << error.what();
}

TEST(LasWriter, RefusesWritingAfterTheEnd)
{
    TemporaryFolder folder;
    LasWriter writer(folder / "a.las", grid);
    writer.finish();
    LasPoint p;
    EXPECT_EQ(error_of([&] { writer.write(&p, 1); }).code(), ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { writer.finish(); }).code(), ErrorCode::invalid_argument);
}

TEST(LasWriter, RefusesGridsThatAreNone)
{
    TemporaryFolder folder;
    for (const double scale :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_EQ(error_of([&] {
                      LasWriter(folder / "a.las", Grid{{1, scale, 1}, {0, 0, 0}});
                  }).code(),
                  ErrorCode::invalid_argument);
    EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(LasWriter, ErrorsOfTheSystemNameTheFile)
{
    TemporaryFolder folder;
    const Error error = error_of([&] { LasWriter(folder / "nowhere" / "a.las", grid); });
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    EXPECT_TRUE(mentions(error.what(), "nowhere"));
}

TEST(LasWriter, AFullDiskIsAnErrorAndLeavesNothing)
{
    TemporaryFolder folder;
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = before;
    small.rlim_cur = 3000000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    {
        const auto points = random_points(200000, 4);
        LasWriter writer(folder / "a.las", grid);
        EXPECT_EQ(error_of([&] { writer.write(points.data(), points.size()); }).code(), ErrorCode::no_space);
    }
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old_handler);
    EXPECT_EQ(files_in(folder.path()), 0u);
}

}  // namespace
}  // namespace pcm::test
