#include "pcm/io/pts/pts_reader.h"

#include "tests/io/text/read_text.h"

namespace pcm::test {
namespace {

TEST(Pts, Columns)
{
    EXPECT_EQ(names_of(read_text("1   \n1 2 3 -1024 5 6 7\n", "a.pts").info.schema), "intensity:i16 rgb:u8x3");
    EXPECT_EQ(names_of(read_text("1 2 3 0.25\n", "a.pts").info.schema), "intensity:f32");
    EXPECT_EQ(names_of(read_text("1 2 3 1 0 0\n", "a.pts").info.schema), "rgb:u8x3");
    const Whole lists = read_text("2\n1 2 3\n4 5 6\n\n1\n7 8 9\n", "a.pts");
    EXPECT_EQ(lists.points.size, 3u);
    EXPECT_EQ(lists.position(2), (Vec3d{7, 8, 9}));
    EXPECT_EQ(read_text("0\n", "a.pts").points.size, 0u);
}

}  // namespace
}  // namespace pcm::test
