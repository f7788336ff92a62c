// PLY and ascii PCD with more than their headers promise: what is not read is counted and shown.
#include "tests/io/ply/ascii_ply.h"
#include "tests/io/text/read_text.h"

namespace pcm::test {
namespace {

const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";

std::string binary_ply(std::size_t count, const std::string& properties, const std::string& after = "")
{
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) + "\n" + properties + after +
           "end_header\n";
}

TEST(PlySurplus, LinesAfterTheLastVertex)
{
    const auto notes = notes_after(ascii_ply(xyz, 2, "1 2 3\n4 5 6\n\n7 8 9\n10 11 12\n"), "a.ply");
    EXPECT_TRUE(any_mentions(notes, "2 lines after the last point are ignored, the first is line 11: '7 8 9'"));
    EXPECT_TRUE(any_mentions(notes, "the header promises 2 vertices"));
    EXPECT_TRUE(any_mentions(notes_after(ascii_ply(xyz, 0, "7 8 9\n"), "a.ply"), "1 line after the last point is"));
    EXPECT_TRUE(notes_after(ascii_ply(xyz, 2, "1 2 3\n4 5 6\n\n \n"), "a.ply").empty());
    // The lines of faces are theirs; one more is not.
    const std::string mesh = ascii_ply(xyz + face, 1, "1 2 3\n3 0 0 0\n");
    EXPECT_FALSE(any_mentions(notes_after(mesh, "a.ply"), "last point"));
    EXPECT_TRUE(any_mentions(notes_after(mesh + "3 0 0 0\n", "a.ply"), "1 line after the last point is ignored"));
}

TEST(PlySurplus, BytesAfterTheLastVertex)
{
    Bytes points;
    for (int i = 0; i < 9; ++i) points.put(static_cast<float>(i));
    const auto notes = notes_after(binary_ply(2, xyz) + points.data, "a.ply");
    EXPECT_TRUE(any_mentions(notes,
                             "12 bytes after the last point are ignored: the header promises 2 vertices, and as "
                             "many bytes as 1 more take follow"));
    EXPECT_TRUE(any_mentions(notes_after(binary_ply(3, xyz) + points.data + "x", "a.ply"), "1 bytes after"));
    EXPECT_TRUE(notes_after(binary_ply(3, xyz) + points.data, "a.ply").empty());
    // Elements of a known size follow.
    const std::string camera = "element camera 1\nproperty float f\n";
    EXPECT_FALSE(any_mentions(notes_after(binary_ply(2, xyz, camera) + points.data.substr(0, 28), "a.ply"), "bytes"));
    EXPECT_TRUE(any_mentions(notes_after(binary_ply(2, xyz, camera) + points.data, "a.ply"), "8 bytes after"));
    // Vertices with lists.
    const std::string lists = binary_ply(1, xyz + "property list uchar uchar l\n") + points.data.substr(0, 12) + '\0';
    EXPECT_FALSE(any_mentions(notes_after(lists, "a.ply"), "after the last point"));
    EXPECT_TRUE(any_mentions(notes_after(lists + "abc", "a.ply"), "3 bytes after the last point"));
}

TEST(PcdSurplus, LinesAfterTheLastPoint)
{
    const auto pcd = [](int points, const std::string& rows) {
        return "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + std::to_string(points) +
               "\nHEIGHT 1\nPOINTS " + std::to_string(points) + "\nDATA ascii\n" + rows;
    };
    EXPECT_TRUE(any_mentions(notes_after(pcd(1, "1 2 3\n4 5 6\n7 8 9\n"), "a.pcd"),
                             "2 lines after the last point are ignored, the first is line 11: '4 5 6'; the header "
                             "promises 1 point"));
    EXPECT_TRUE(any_mentions(notes_after(pcd(0, "4 5 6\n"), "a.pcd"), "1 line after the last point is ignored"));
    EXPECT_TRUE(notes_after(pcd(1, "1 2 3\n"), "a.pcd").empty());
}

}  // namespace
}  // namespace pcm::test
