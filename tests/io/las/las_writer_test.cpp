// LAS and LAZ written and read back: every bit, every field of the header.
#include "tests/io/las/las_clouds.h"

#include <sys/resource.h>

#include <cmath>
#include <csignal>

namespace pcm::test {
namespace {

// Every point format, with described and undescribed extra bytes, through LAS and LAZ.
TEST(LasWriter, EveryPointFormatRoundTrips)
{
    std::mt19937_64 random(1);
    TemporaryFolder folder;
    for (int format = 0; format <= 10; ++format)
        for (const std::size_t extra : {0, 5}) {
            LasFile file = random_las(random, 4, format, 3000, extra);
            file.vlrs = {{"LASF_Projection", 34735, "keys"}, {"a/b%2F", 7, ""}};
            file.evlrs = {{"far", 9, std::string(70000, 'e')}};
            if (extra) file.vlrs.push_back({"LASF_Spec", 4, extra_descriptor(4, 0x18, "a", {0.1, 0, 0}, {7, 0, 0})});
            const Whole source = read_whole(write_file(folder / "source.las", file.bytes()));
            for (const std::string& extension : las_extensions()) {
                SCOPED_TRACE(std::to_string(format) + " " + extension + " " + std::to_string(extra));
                const auto path = folder / ("copy." + extension);
                const Written written = write_cloud(path, source);
                EXPECT_EQ(written.position_error, 0);
                const Whole copy = read_whole(path);
                expect_same_cloud(source, copy);
                EXPECT_TRUE(mentions(copy.info.format, "1.4, point format " + std::to_string(format)));
                EXPECT_EQ(without_header(source.info), without_header(copy.info));
                EXPECT_TRUE(copy.info.notes.empty());
                EXPECT_EQ(any_mentions(written.notes, "waveforms are not copied"), has_wave(format));
            }
        }
}

TEST(LasWriter, ThreadsDoNotChangeTheBytes)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    std::mt19937_64 random(2);
    for (const int format : {3, 8}) {
        LasFile file = random_las(random, 4, format, 0);
        Whole cloud = read_whole(write_file(folder / "source.las", file.bytes()));
        cloud.points.resize(170001);  // four chunks, the last one short
        randomize(cloud.points, random);
        for (std::size_t c = 0; c < cloud.points.attributes.size(); ++c)
            if (cloud.info.schema[c].type == ScalarType::u8)
                std::fill_n(cloud.points.attributes[c].as<std::uint8_t>(), cloud.points.size, std::uint8_t{1});
        std::string first;
        for (const unsigned threads : {1u, 2u, 4u, 0u}) {
            WriteOptions options;
            options.threads = threads;
            write_cloud(folder / "a.laz", cloud, options, 60000);
            const std::string bytes = read_bytes(folder / "a.laz");
            if (first.empty()) first = bytes;
            EXPECT_TRUE(bytes == first) << threads << " threads";
            ReadOptions reading;
            reading.threads = threads;
            expect_same_cloud(cloud, read_whole(*open_reader(folder / "a.laz", reading)));
        }
    }
}

// The header's bytes, frozen.
TEST(LasWriter, BytesOfOnePoint)
{
    TemporaryFolder folder;
    Whole cloud = gridded_cloud(schema_of({{"rgb", ScalarType::u16, 3, 1, 0, {}},
                                           {"intensity", ScalarType::u16, 1, 1, 0, {}},
                                           {"point_source_id", ScalarType::u16, 1, 1, 0, {}}}),
                                1, 1);
    cloud.info.grid = Grid{{1, 1, 1}, {0, 0, 0}};
    for (std::size_t a = 0; a < 3; ++a) cloud.points.grid_xyz[a][0] = static_cast<std::int32_t>(a + 1);
    const std::uint16_t colour[3] = {0x090A, 0x0B0C, 0x0D0E};
    std::memcpy(cloud.points.attributes[0].data(), colour, 6);
    *cloud.points.attributes[1].as<std::uint16_t>() = 0x0405;
    *cloud.points.attributes[2].as<std::uint16_t>() = 0x0708;
    EXPECT_TRUE(write_cloud(folder / "a.las", cloud).notes.empty());

    Bytes expected;
    expected.raw("LASF").put(0u).text("", 16).put(std::uint8_t{1}).put(std::uint8_t{2}).text("OTHER", 32);
    expected.text("pcm", 32).put(std::uint16_t{1}).put(std::uint16_t{2025}).put(std::uint16_t{227}).put(227u).put(0u);
    expected.put(std::uint8_t{2}).put(std::uint16_t{26}).put(1u).put(1u).put(0u).put(0u).put(0u).put(0u);
    for (const double value : {1., 1., 1., 0., 0., 0., 1., 1., 2., 2., 3., 3.}) expected.put(value);
    expected.put(1).put(2).put(3).put(std::uint16_t{0x0405}).put(std::uint8_t{9}).put(std::uint8_t{0});
    expected.put(std::uint16_t{0}).put(std::uint16_t{0x0708});
    for (const std::uint16_t c : colour) expected.put(c);
    EXPECT_EQ(read_bytes(folder / "a.las"), expected.data);
}

TEST(LasWriter, HeaderOfTheSourceIsKept)
{
    std::mt19937_64 random(3);
    TemporaryFolder folder;
    Bytes source;
    source.raw(random_las(random, 2, 3, 100).bytes());
    source.overwrite(6, std::uint16_t{1 | 2 | 4});  // GPS time type; waveforms, which are not copied
    for (std::size_t i = 0; i < 16; ++i) source.data[8 + i] = static_cast<char>(i + 100);
    const Whole cloud = read_whole(write_file(folder / "a.las", source.data));
    write_cloud(folder / "b.las", cloud);
    const std::string copy = read_bytes(folder / "b.las");
    EXPECT_EQ(copy.substr(4, 2), source.data.substr(4, 2)) << "file source id";
    EXPECT_EQ(copy.substr(6, 2), std::string("\1\0", 2)) << "global encoding";
    EXPECT_EQ(copy.substr(8, 16), source.data.substr(8, 16)) << "GUID";
    EXPECT_EQ(copy.substr(26, 68), source.data.substr(26, 68)) << "system, software, date";
    EXPECT_EQ(copy.substr(131, 48), source.data.substr(131, 48)) << "scale and offset";
}

TEST(LasWriter, CountsAndBoxAreThoseOfThePoints)
{
    std::mt19937_64 random(4);
    TemporaryFolder folder;
    for (const int format : {1, 6}) {
        const LasFile file = random_las(random, 4, format, 5000);
        const Whole cloud = read_whole(write_file(folder / "a.las", file.bytes()));
        write_cloud(folder / "b.las", cloud);
        std::array<std::uint64_t, 16> returns{};
        for (const LasRecord& record : file.records) ++returns[record.return_number];
        const std::string copy = read_bytes(folder / "b.las");
        const auto number = [&](std::size_t at, auto type) {
            std::memcpy(&type, copy.data() + at, sizeof type);
            return static_cast<std::uint64_t>(type);
        };
        for (std::size_t r = 1; r <= 15; ++r) EXPECT_EQ(number(255 + 8 * (r - 1), std::uint64_t{}), returns[r]);
        EXPECT_EQ(number(247, std::uint64_t{}), 5000u);
        EXPECT_EQ(number(107, 0u), format == 1 ? 5000u : 0u);
        for (std::size_t r = 1; r <= 5; ++r)
            EXPECT_EQ(number(111 + 4 * (r - 1), 0u), format == 1 ? returns[r] : 0u) << r;
        Box3d box;
        for (std::size_t i = 0; i < cloud.points.size; ++i) box.extend(cloud.position(i));
        EXPECT_EQ(*read_whole(folder / "b.las").info.promised_box, box) << "exact, not rounded";
    }
}

TEST(LasWriter, EverySampleRoundTrips)
{
    PCM_REQUIRE_SAMPLE("las");
    TemporaryFolder folder;
    std::size_t files = 0;
    for (const char* where : {"las", "crossformat"})
        for (const auto& entry : std::filesystem::directory_iterator(sample(where))) {
            const auto from = entry.path().extension().string();
            if (from != ".las" && (from != ".laz" || !have_laz())) continue;
            if (std::filesystem::file_size(entry.path()) > 1500000) continue;  // minutes under sanitizers
            SCOPED_TRACE(entry.path().filename());
            ++files;
            const Whole source = read_whole(entry.path());
            for (const std::string& extension : las_extensions()) {
                SCOPED_TRACE(extension);
                const auto path = folder / ("copy." + extension);
                const Written written = write_cloud(path, source, {}, 50000);
                const Whole copy = read_whole(path);
                expect_same_cloud(source, copy);
                EXPECT_EQ(written.position_error, 0);
                std::vector<Metadata> kept = without_header(source.info);
                const auto is_copc = [](const Metadata& m) { return mentions(m.key, "vlr/copc/"); };
                const bool copc = any_mentions(written.notes, "COPC");
                EXPECT_EQ(copc, std::any_of(kept.begin(), kept.end(), is_copc));
                kept.erase(std::remove_if(kept.begin(), kept.end(), is_copc), kept.end());
                EXPECT_EQ(kept, without_header(copy.info));
            }
        }
    EXPECT_GE(files, 24u);
}

TEST(LasWriter, DoublesAreRoundedToTheGridAndTheErrorIsReported)
{
    TemporaryFolder folder;
    const Whole cloud = doubles({{5000000.0012, -3000000, 100.25}, {5000000.1, -2999999.998, 99}});
    EXPECT_EQ(error_of([&] { create_writer(folder / "a.las", cloud.info); }).code(), ErrorCode::invalid_argument);
    WriteOptions options;
    options.grid = grid;
    const Written written = write_cloud(folder / "a.las", cloud, options);
    const Whole copy = read_whole(folder / "a.las");
    EXPECT_EQ(copy.info.grid, grid);
    double error = 0;
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            const double off = std::abs(copy.position(i)[a] - cloud.position(i)[a]);
            EXPECT_LE(off, grid.scale[a] / 2 + 1e-9);
            error = std::max(error, off);
        }
    EXPECT_EQ(written.position_error, error);
    EXPECT_EQ(error, 0.25);
}

TEST(LasWriter, AnotherGridThanTheSourcesRoundsAndReportsIt)
{
    TemporaryFolder folder;
    Whole cloud = gridded_cloud({}, 1000, 1);
    for (auto& axis : cloud.points.grid_xyz)
        for (auto& q : axis) q /= 1000;
    WriteOptions options;
    options.grid = Grid{{0.01, 0.01, 1}, {5e6, -3e6, 100}};
    const Written written = write_cloud(folder / "a.las", cloud, options);
    const Whole copy = read_whole(folder / "a.las");
    double error = 0;
    for (std::size_t i = 0; i < 1000; ++i)
        for (std::size_t a = 0; a < 3; ++a)
            error = std::max(error, std::abs(copy.position(i)[a] - cloud.position(i)[a]));
    EXPECT_EQ(written.position_error, error);
    EXPECT_NEAR(error, 0.5, 1e-6);
}

TEST(LasWriter, PositionsThatAreNotFiniteAreLeftOutAndCounted)
{
    TemporaryFolder folder;
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    const Whole cloud =
        doubles({{5000000, -3000000, 100}, {nan, -3000000, 100}, {5000001, -3000000, 101}, {5000000, infinity, 1}});
    WriteOptions options;
    options.grid = grid;
    const Written written = write_cloud(folder / "a.las", cloud, options);
    EXPECT_TRUE(any_mentions(written.notes, "2 points without a finite position")) << written.notes.size();
    const Whole copy = read_whole(folder / "a.las");
    ASSERT_EQ(copy.points.size, 2u);
    EXPECT_EQ(copy.value("id", 0), 0);
    EXPECT_EQ(copy.value("id", 1), 2);
}

TEST(LasWriter, PositionsBeyondTheGridAreAnErrorThatSaysWhatToDo)
{
    TemporaryFolder folder;
    WriteOptions options;
    options.grid = grid;
    for (const double x : {5e6 + 2147483.6480, 5e6 - 2147483.65, 1e300, -1e300}) {
        const Error error = error_of([&] {
            write_cloud(folder / "a.las", doubles({{5e6, -3e6, 100}, {x, -3e6, 100}}), options);
        });
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        for (const char* part : {"x = ", "point 2", "step 0.001", "larger step"})
            EXPECT_TRUE(mentions(error.what(), part)) << error.what();
    }
    EXPECT_EQ(files_in(folder.path()), 0u);
    const Whole whole = doubles({{5e6 + 2147483.647, -3e6, 100}, {5e6 - 2147483.648, -3e6, 100}});
    EXPECT_LT(write_cloud(folder / "a.las", whole, options).position_error, 1e-9);
}

TEST(LasWriter, NoPoints)
{
    TemporaryFolder folder;
    for (const std::string& extension : las_extensions()) {
        const auto path = folder / ("a." + extension);
        write_cloud(path, gridded_cloud({}, 0, 1));
        EXPECT_EQ(read_whole(path).points.size, 0u);
    }
}

TEST(LasWriter, LeavesNothingBehindWithoutFinish)
{
    TemporaryFolder folder;
    for (const std::string& extension : las_extensions()) {
        const auto path = write_file(folder / ("a." + extension), "the old file");
        {
            const Whole cloud = gridded_cloud({}, 120000, 3);
            WriteOptions options;
            options.threads = 3;
            const auto writer = create_writer(path, cloud.info, options);
            writer->write(cloud.points);
            EXPECT_EQ(read_bytes(path), "the old file");
        }
        EXPECT_EQ(files_in(folder.path()), 1u);
        EXPECT_EQ(read_bytes(path), "the old file");
        std::filesystem::remove(path);
    }
}

TEST(LasWriter, RefusesWritingAfterTheEndAndOtherBatches)
{
    TemporaryFolder folder;
    const Whole cloud = gridded_cloud({}, 1, 1), other = doubles({{1, 2, 3}});
    const auto writer = create_writer(folder / "a.las", cloud.info);
    EXPECT_EQ(error_of([&] { writer->write(other.points); }).code(), ErrorCode::invalid_argument);
    writer->finish();
    EXPECT_EQ(error_of([&] { writer->write(cloud.points); }).code(), ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { writer->finish(); }).code(), ErrorCode::invalid_argument);
}

TEST(LasWriter, RefusesInvalidGrids)
{
    TemporaryFolder folder;
    for (const double scale :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        FileInfo cloud;
        cloud.grid = Grid{{1, scale, 1}, {0, 0, 0}};
        EXPECT_EQ(error_of([&] { create_writer(folder / "a.las", cloud); }).code(), ErrorCode::invalid_argument);
    }
    EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(LasWriter, ErrorsOfTheSystemNameTheFile)
{
    TemporaryFolder folder;
    const Error error = error_of([&] { create_writer(folder / "nowhere" / "a.las", gridded_cloud({}, 1, 1).info); });
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
    small.rlim_cur = 1500000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const Whole cloud = gridded_cloud({}, 300000, 4);
    for (const std::string& extension : las_extensions()) {
        WriteOptions options;
        options.threads = 2;
        EXPECT_EQ(error_of([&] { write_cloud(folder / ("a." + extension), cloud, options); }).code(),
                  ErrorCode::no_space);
    }
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old_handler);
    EXPECT_EQ(files_in(folder.path()), 0u);
}

}  // namespace
}  // namespace pcm::test
