#include "pcm/system/rounded_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using pcm::rounded_text;

TEST(RoundedText, DigitsThatAreKnown)
{
    EXPECT_EQ(rounded_text(0.06484816579714246, 0.000528), "0.06485");
    EXPECT_EQ(rounded_text(500045.3185791015, 0.0001), "500045.31858");
    EXPECT_EQ(rounded_text(500045.3185791015, 0.00099), "500045.31858");
    EXPECT_EQ(rounded_text(500045.3185791015, 0.001), "500045.3186");
    EXPECT_EQ(rounded_text(-12.25, 3), "-12.2");
    EXPECT_EQ(rounded_text(1234.5, 250), "1234");
    EXPECT_EQ(rounded_text(2.0, 0.01), "2.000");
    EXPECT_EQ(rounded_text(-1e-9, 0.01), "0.000");
    EXPECT_EQ(rounded_text(1e-30, 1e-25), "0.000000000000000");
    EXPECT_EQ(rounded_text({1.23456, -2, 0}, 0.01), "1.235 -2.000 0");
}

TEST(RoundedText, UncertaintiesThatSayNothing)
{
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_EQ(rounded_text(848935.2000000001, 0), "848935.2000000001");
    EXPECT_EQ(rounded_text(848935.2000000001, std::nan("")), "848935.2000000001");
    EXPECT_EQ(rounded_text(12.34567891, infinite), "12.3457");
    EXPECT_EQ(rounded_text(4800567.8123, infinite), "4800568");
    EXPECT_EQ(rounded_text(std::nan(""), 0.1), "nan");
    EXPECT_EQ(rounded_text(infinite, 0.1), "inf");
    EXPECT_EQ(rounded_text(5e-324, infinite), "0.000000000000000");
    EXPECT_EQ(rounded_text(1e300, 1e-300).substr(0, 3), "100");
}

}  // namespace
