// Damaged and truncated PLY files are refused with the place and the cause.
#include "pcm/io/ply/ply_reader.h"
#include "tests/io/bytes.h"
#include "tests/io/ply/ascii_ply.h"

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

namespace pcm::test {
namespace {

TEST(PlyReader, BadLinesAreNamed)
{
    struct {
        const char* line;
        const char* found;
        const char* expected;
    } const cases[] = {{"1 2 x 4", "'x'", "f32"},
                       {"1 2 3", "'1 2 3'", "ends before the property 'red'"},
                       {"1 2 3 4 5", "'5'", "end of the line"},
                       {"1 2 3 256", "'256'", "u8"},
                       {"1 2 3 -1", "'-1'", "u8"},
                       {"1 2 3 1.5", "'1.5'", "u8"},
                       {"1 2,5 3 1", "'2,5'", "'y'"},
                       {"1 2 0x3 1", "'0x3'", "'z'"},
                       {"1 2 +-3 1", "'+-3'", "'z'"},
                       {"1 2 3 nan", "'nan'", "u8"}};
    TemporaryFolder folder;
    for (const auto& c : cases) {
        // Line 9 with the blank one: ply, format, element, four properties, end_header, a vertex, blank, this.
        const auto path = write_file(folder / "a.ply", ascii_ply(xyz + "property uchar red\n", 3,
                                                                 std::string("0 0 0 0\n\n") + c.line + "\n0 0 0 0\n"));
        const Error error = error_of([&] { read_whole(*open_reader(path)); });
        EXPECT_EQ(error.code(), ErrorCode::bad_format);
        for (const std::string& part :
             {std::string("line 11"), std::string(c.found), std::string(c.expected), path.string()})
            EXPECT_TRUE(mentions(error.what(), part)) << part << " in " << error.what();
    }
}

TEST(PlyReader, BadHeadersAreNamed)
{
    struct {
        const char* header;
        ErrorCode code;
        const char* says;
    } const cases[] = {
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n", ErrorCode::bad_format, "end_header"},
        {"ply\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
         ErrorCode::bad_format, "format"},
        {"ply\nformat binary 1.0\nend_header\n", ErrorCode::bad_format, "line 2"},
        {"ply\nformat ascii 2.0\nend_header\n", ErrorCode::unsupported, "2.0"},
        {"ply\nformat ascii 1.0\nend_header\n", ErrorCode::bad_format, "vertex"},
        {"ply\nformat ascii 1.0\nelement point 3\nend_header\n", ErrorCode::bad_format, "'point'"},
        {"ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", ErrorCode::bad_format, "'-1'"},
        {"ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nend_header\n", ErrorCode::bad_format, "line 3"},
        {"ply\nformat ascii 1.0\nelement vertex\nend_header\n", ErrorCode::bad_format, "line 3"},
        {"ply\nformat ascii 1.0\nproperty float x\nend_header\n", ErrorCode::bad_format, "before the first element"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty flat x\nend_header\n", ErrorCode::bad_format, "'flat'"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float\nend_header\n", ErrorCode::bad_format, "no name"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\nend_header\n", ErrorCode::bad_format,
         "floating-point"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
         ErrorCode::bad_format, "'z'"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\nend_header\n0 0\n",
         ErrorCode::bad_format, "'x'"},
        {"ply\nformat ascii 1.0\nelement vertex 0\nelement vertex 0\nend_header\n", ErrorCode::bad_format,
         "two elements"},
        {"ply\nformat ascii 1.0\nbanana\nend_header\n", ErrorCode::bad_format, "'banana'"},
    };
    TemporaryFolder folder;
    for (const auto& c : cases) {
        const auto path = write_file(folder / "a.ply", c.header);
        const Error error = error_of([&] { open_reader(path); });
        EXPECT_EQ(error.code(), c.code) << c.header << error.what();
        EXPECT_TRUE(mentions(error.what(), c.says)) << error.what();
        EXPECT_TRUE(mentions(error.what(), path.string())) << error.what();
    }
    // A header without end, far larger than any real one.
    std::string endless = "ply\nformat ascii 1.0\n";
    while (endless.size() < 3000000) endless += "comment nothing to see\n";
    EXPECT_EQ(error_of([&] { open_reader(write_file(folder / "a.ply", endless)); }).code(), ErrorCode::bad_format);
    // Long, but real; and the words of the last line in a comment.
    std::string large = "ply\nformat ascii 1.0\ncomment end_header\n" + endless.substr(21, 200000);
    large = large.substr(0, large.rfind('\n') + 1) + "element vertex 1\n" + xyz + "end_header\n7 8 9\n";
    EXPECT_EQ(read_whole(write_file(folder / "a.ply", large)).position(0), (Vec3d{7, 8, 9}));
}

TEST(PlyReader, MoreAttributesThanASchemaHolds)
{
    std::string properties = xyz, line = "0 0 0";
    for (int i = 0; i < 256; ++i) properties += "property uchar a" + std::to_string(i) + "\n", line += " 7";
    TemporaryFolder folder;
    EXPECT_EQ(read_whole(write_file(folder / "a.ply", ascii_ply(properties, 1, line))).value("a255", 0), 7);
    const Error error = error_of([&] {
        open_reader(write_file(folder / "a.ply", ascii_ply(properties + "property uchar more\n", 1, line + " 7")));
    });
    EXPECT_EQ(error.code(), ErrorCode::unsupported);
    EXPECT_TRUE(mentions(error.what(), "a.ply"));
}

TEST(PlyReader, PromisesThatCannotBeKeptAreRefusedAtOpen)
{
    TemporaryFolder folder;
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"})
        for (const char* count : {"2", "1000000000000", "18446744073709551615"}) {
            const auto path =
                write_file(folder / "a.ply", std::string("ply\nformat ") + format + " 1.0\nelement vertex " + count +
                                                 "\n" + xyz + "end_header\n0 0 0 .");
            const Error error = error_of([&] { open_reader(path); });
            EXPECT_EQ(error.code(), ErrorCode::truncated) << error.what();
            EXPECT_TRUE(mentions(error.what(), count)) << error.what();
        }
}

TEST(PlyReader, EveryTruncationOfABinaryFileIsRefusedAtOpen)
{
    Bytes file;
    file.raw("ply\nformat binary_little_endian 1.0\nelement vertex 4\n" + xyz + "property uchar red\nend_header\n");
    for (int i = 0; i < 4; ++i) file.put(1.0f).put(2.0f).put(3.0f).put(std::uint8_t{4});
    TemporaryFolder folder;
    for (std::size_t length = 0; length < file.data.size(); ++length) {
        const auto path = write_file(folder / "a.ply", file.data.substr(0, length));
        const Error error = error_of([&] { open_reader(path); });
        ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
        ASSERT_EQ(error.code(), length < file.data.size() - 52 ? ErrorCode::bad_format : ErrorCode::truncated)
            << length << error.what();
    }
    EXPECT_EQ(read_whole(write_file(folder / "a.ply", file.data)).points.size, 4u);
}

// Text can be cut within its last number without a trace; anything shorter is noticed.
TEST(PlyReader, EveryTruncationOfAnAsciiFileIsNoticed)
{
    const std::string file = ascii_ply(xyz, 4, "1.25 2.25 3.25\n1.5 2.5 3.5\n-1 -2 -3\n10 20 305\n");
    TemporaryFolder folder;
    for (std::size_t length = 0; length < file.size(); ++length) {
        const auto path = write_file(folder / "a.ply", file.substr(0, length));
        if (length > file.size() - 4) {
            EXPECT_EQ(read_whole(path).points.size, 4u);
            continue;
        }
        const Error error = error_of([&] { read_whole(*open_reader(path)); });
        ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
        ASSERT_TRUE(error.code() == ErrorCode::bad_format || error.code() == ErrorCode::truncated)
            << length << error.what();
    }
}

TEST(PlyReader, NegativeAndEndlessLists)
{
    TemporaryFolder folder;
    for (const std::int32_t length : {-1, 2147483647}) {
        Bytes file;
        file.raw(
            "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list int double v\nelement vertex 1\n" +
            xyz + "end_header\n");
        file.put(length).put(1.0).put(1.0f).put(1.0f).put(1.0f);
        const auto reader = open_reader(write_file(folder / "a.ply", file.data));
        PointBatch batch;
        EXPECT_EQ(error_of([&] { reader->read(batch, 1); }).code(),
                  length < 0 ? ErrorCode::bad_format : ErrorCode::truncated);
    }
    Bytes file;  // the length times eight is 8 modulo 2^64
    file.raw("ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint64 double v\nelement vertex 1\n" +
             xyz + "end_header\n");
    file.put(std::uint64_t{0x2000000000000001u}).put(1.0).put(1.0f).put(1.0f).put(1.0f);
    const auto reader = open_reader(write_file(folder / "a.ply", file.data));
    PointBatch batch;
    EXPECT_EQ(error_of([&] { reader->read(batch, 1); }).code(), ErrorCode::truncated);
}

TEST(PlyReader, NoVertices)
{
    TemporaryFolder folder;
    const Whole whole = read_whole(write_file(folder / "a.ply", ascii_ply(xyz + "property uchar alpha\n", 0, "")));
    EXPECT_EQ(whole.points.size, 0u);
    EXPECT_TRUE(whole.info.schema.find("alpha"));
}

TEST(PlyReader, LinesLongerThanTheBuffer)
{
    const std::size_t numbers = 1500000;
    std::string body = "1 2 3 " + std::to_string(numbers);
    for (std::size_t i = 0; i < numbers; ++i) body += " 7";
    TemporaryFolder folder;
    const Whole whole = read_whole(
        write_file(folder / "a.ply", ascii_ply(xyz + "property list uint uchar long\n", 2, body + "\n4 5 6 0\n")));
    EXPECT_EQ(whole.position(1), (Vec3d{4, 5, 6}));
}

}  // namespace
}  // namespace pcm::test
