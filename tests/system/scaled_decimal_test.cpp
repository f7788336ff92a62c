#include "pcm/system/scaled_decimal.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace {

using pcm::ScaledDecimal;

std::string text(double scale, double offset, std::int64_t q)
{
    char to[ScaledDecimal::longest];
    const char* const end = ScaledDecimal(scale, offset).write(to, q);
    return end ? std::string(to, static_cast<std::size_t>(end - to)) : "none";
}

TEST(ScaledDecimal, IsTheNumberThatTheIntegerStandsFor)
{
    EXPECT_EQ(text(0.1, 0, 7), "0.7");
    EXPECT_EQ(text(0.1, 0, 3), "0.3");
    EXPECT_EQ(text(0.001, 500000, 123), "500000.123");
    EXPECT_EQ(text(0.001, -4800000, -5), "-4800000.005");
    EXPECT_EQ(text(0.001, 0, -7), "-0.007");
    EXPECT_EQ(text(0.01, 0, 1200), "12");
    EXPECT_EQ(text(1000, 0, 12), "12000");
    EXPECT_EQ(text(0.00025, 0.5, 1), "0.50025");
    EXPECT_EQ(text(5e-7, 475.011, -1023150000), "-36.564");
    EXPECT_EQ(text(0.006, 0, -30000), "-180");
    EXPECT_EQ(text(0.001, 0, 0), "0");
    EXPECT_EQ(text(0.001, -0.0, 0), "0");
    EXPECT_EQ(text(1, 0, -2147483648LL), "-2147483648");
}

TEST(ScaledDecimal, OtherNumbersAreTextToo)
{
    EXPECT_EQ(pcm::decimal_text(370338855, 0.01, 0), "3703388.55");
    EXPECT_EQ(pcm::decimal_text(3, 0x1p-40, 0.5), "0.5000000000027285");
    EXPECT_EQ(pcm::decimal_text(3, 1e-300, 0), "3e-300");
}

TEST(ScaledDecimal, NumbersThatPeopleDoNotWriteAreLeftToOthers)
{
    EXPECT_EQ(text(1e-7, 0, 3), "none");           // 3e-07
    EXPECT_EQ(text(1e12, 0, 3000), "none");        // 3e+15
    EXPECT_EQ(text(1.0 / 3, 0, 1234567), "none");  // more than 17 digits
    EXPECT_EQ(text(0x1p-40, 0, 3), "none");
    EXPECT_EQ(text(1e-300, 0, 1), "none");
    EXPECT_EQ(text(1e300, 0, 1), "none");
    EXPECT_EQ(text(0.001, std::nan(""), 1), "none");
    EXPECT_EQ(text(0.1, 0, std::numeric_limits<std::int64_t>::min()), "none");
}

// What is read back differs from the place on the grid by rounding only, and its nearest place is the same.
TEST(ScaledDecimal, ReadsBackAsTheSamePlace)
{
    std::mt19937_64 random(1);
    for (const double scale : {1.0, 0.1, 0.01, 0.001, 0.0001, 0.00025, 1e-5, 2e-7})
        for (const double offset : {0.0, 500000.0, -4800000.5, 12.345})
            for (int i = 0; i < 2000; ++i) {
                const auto q = static_cast<std::int32_t>(random());
                const std::string written = text(scale, offset, q);
                if (written == "none") continue;
                double read = 0;
                const auto end = std::from_chars(written.data(), written.data() + written.size(), read);
                ASSERT_EQ(end.ptr, written.data() + written.size()) << written;
                const double place = q * scale + offset;
                ASSERT_LE(std::fabs(read - place), 1e-15 * (std::fabs(q * scale) + std::fabs(offset))) << written;
                ASSERT_EQ(std::llround((read - offset) / scale), q) << written;
                ASSERT_LE(written.size(), 20u) << written;
            }
}

}  // namespace
