#include "pcm/align/pair_text.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <fstream>

namespace pcm {
namespace {

std::string refusal(const std::string& text)
{
    try {
        parse_pairs(text, "pairs.txt");
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::bad_format);
        return error.what();
    }
    return "accepted";
}

TEST(PairText, ReadsAllSeparatorsCommentsAndWeights)
{
    const auto pairs = parse_pairs(
        "# moving, fixed\r\n500010.25 4800020.5 131.5\t1 2 3\r\n\n  # nothing\n"
        "1,2,3;4,5,6,0.5 # a half\n-1e-3 +2 .5 4 5 6",
        "text");
    ASSERT_EQ(pairs.size(), 3u);
    EXPECT_EQ(pairs[0].moving, (Vec3d{500010.25, 4800020.5, 131.5}));
    EXPECT_EQ(pairs[0].fixed, (Vec3d{1, 2, 3}));
    EXPECT_EQ(pairs[0].weight, 1);
    EXPECT_EQ(pairs[1].fixed, (Vec3d{4, 5, 6}));
    EXPECT_EQ(pairs[1].weight, 0.5);
    EXPECT_EQ(pairs[2].moving, (Vec3d{-0.001, 2, 0.5}));
    EXPECT_TRUE(parse_pairs("", "text").empty());
}

TEST(PairText, RefusesWhatIsNoPairAndNamesTheLine)
{
    EXPECT_NE(refusal("1 2 3 4 5 6\n\n1 2 3 4 5\n").find("line 3: 6 or 7 numbers were expected, and there are 5"),
              std::string::npos);
    EXPECT_NE(refusal("1 2 3 4 5 6 7 8").find("there are 8"), std::string::npos);
    EXPECT_NE(refusal("1 2 3 4 5 six").find("line 1: 'six' is not a number"), std::string::npos);
    EXPECT_NE(refusal("1 2 3 4 5 nan").find("'nan' is not finite"), std::string::npos);
    EXPECT_NE(refusal("1 2 3 4 5 6 -1").find("the weight is below 0"), std::string::npos);
    EXPECT_NE(refusal("1 2 3 4 5 6 x").find("pairs.txt"), std::string::npos);
}

TEST(PairText, WritesEveryDigit)
{
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "pairs.txt";
    const std::vector<PointPair> pairs{{{500010.1234567891, 1.0 / 3, -1e-300}, {1, 2, 3}, 1},
                                       {{4, 5, 6}, {7, 8, 9}, 0.1}};
    write_pairs(pairs, file);
    const auto again = read_pairs(file);
    ASSERT_EQ(again.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(again[i].moving, pairs[i].moving);
        EXPECT_EQ(again[i].fixed, pairs[i].fixed);
        EXPECT_EQ(again[i].weight, pairs[i].weight);
    }
    EXPECT_THROW(read_pairs(folder.path() / "missing.txt"), Error);
    std::ofstream(folder.path() / "huge.txt").close();
    std::filesystem::resize_file(folder.path() / "huge.txt", (16u << 20) + 1);
    EXPECT_THROW(read_pairs(folder.path() / "huge.txt"), Error);
}

}  // namespace
}  // namespace pcm
