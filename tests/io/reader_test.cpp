#include "pcm/io/reader.h"

#include "tests/io/las_file.h"

#include <sys/stat.h>

#include <algorithm>

namespace pcm::test {
namespace {

const std::string small_ply =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
    "3\n";

std::string small_las()
{
    std::mt19937_64 random(1);
    return random_las(random, 2, 0, 1).bytes();
}

TEST(OpenReader, ContentCountsMoreThanTheExtension)
{
    TemporaryFolder folder;
    EXPECT_EQ(open_reader(write_file(folder / "cloud.las", small_ply))->info().format, "PLY ascii");
    EXPECT_EQ(open_reader(write_file(folder / "cloud.ply", small_las()))->info().format, "LAS 1.2, point format 0");
    EXPECT_EQ(open_reader(write_file(folder / "cloud", small_las()))->info().format, "LAS 1.2, point format 0");
    EXPECT_EQ(open_reader(write_file(folder / "cloud.XYZ", small_ply))->info().format, "PLY ascii");
}

TEST(OpenReader, SaysWhatItFound)
{
    struct {
        const char* name;
        std::string bytes;
        ErrorCode code;
        const char* says;
    } const cases[] = {
        {"a.las", "PLY!", ErrorCode::bad_format, "LASF"},
        {"a.ply", "plymouth", ErrorCode::bad_format, "line 1"},
        {"a.dat", std::string("\x01\x02zz", 4), ErrorCode::bad_format, "\\x01\\x02zz"},
        {"a.e57", "ASTM-E57....", ErrorCode::truncated, "1024 bytes"},
        {"a.las", "%PDF-1.7", ErrorCode::unsupported, "PDF"},
        {"a.xyz", "x marks the spot\n", ErrorCode::bad_format, "x marks the spot"},
        {"a.dat", "x marks the spot\n", ErrorCode::bad_format, "x marks the"},
        {"a.laz", "nonsense", ErrorCode::bad_format, "LASF"},
        {"a.las", "", ErrorCode::bad_format, "empty"},
    };
    TemporaryFolder folder;
    for (const auto& c : cases) {
        const auto path = write_file(folder / c.name, c.bytes);
        const Error error = error_of([&] { open_reader(path); });
        EXPECT_EQ(error.code(), c.code) << error.what();
        EXPECT_TRUE(mentions(error.what(), c.says)) << error.what();
        EXPECT_TRUE(mentions(error.what(), path.string())) << error.what();
    }
}

TEST(OpenReader, OnlyRegularFiles)
{
    TemporaryFolder folder;
    EXPECT_EQ(error_of([&] { open_reader(folder / "missing.las"); }).code(), ErrorCode::not_found);
    EXPECT_EQ(error_of([&] { open_reader(folder.path()); }).code(), ErrorCode::unsupported);
    ASSERT_EQ(mkfifo((folder / "pipe.las").c_str(), 0600), 0);
    EXPECT_EQ(error_of([&] { open_reader(folder / "pipe.las"); }).code(), ErrorCode::unsupported);
}

TEST(OpenReader, SeekOfFormatsWithoutIt)
{
    TemporaryFolder folder;
    const auto reader = open_reader(write_file(folder / "a.ply", small_ply));
    EXPECT_FALSE(reader->seekable());
    EXPECT_EQ(error_of([&] { reader->seek(0); }).code(), ErrorCode::unsupported);
}

TEST(ReadableExtensions, AreThoseOfTheFormats)
{
    std::vector<std::string> known = readable_extensions();
    for (const char* expected : {"bpc", "las", "laz", "ply", "xyz", "txt", "asc", "csv", "pwn", "pts", "ptx"})
        EXPECT_EQ(std::count(known.begin(), known.end(), expected), 1) << expected;
}

TEST(ExpandInputs, FoldersStandForTheirFiles)
{
    TemporaryFolder folder;
    std::filesystem::create_directory(folder / "tiles");
    std::filesystem::create_directory(folder / "tiles" / "deeper.las");
    write_file(folder / "tiles" / "b.LAS", "x");
    write_file(folder / "tiles" / "a.ply", "x");
    write_file(folder / "tiles" / "readme.txt", "x");
    write_file(folder / "tiles" / "deeper.las" / "c.las", "x");
    write_file(folder / "one.xyz", "x");
    EXPECT_EQ(expand_inputs({folder / "one.xyz", folder / "tiles"}),
              (std::vector<std::filesystem::path>{folder / "one.xyz", folder / "tiles" / "a.ply",
                                                  folder / "tiles" / "b.LAS"}));
    EXPECT_TRUE(expand_inputs({}).empty());
}

TEST(ExpandInputs, RefusesWhatIsNotThere)
{
    TemporaryFolder folder;
    EXPECT_EQ(error_of([&] { expand_inputs({folder / "missing"}); }).code(), ErrorCode::not_found);
    const Error error = error_of([&] { expand_inputs({folder.path()}); });
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    EXPECT_TRUE(mentions(error.what(), ".las")) << error.what();
}

}  // namespace
}  // namespace pcm::test
