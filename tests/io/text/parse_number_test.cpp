// Whole numbers that are written as such, or as reals.

#include "pcm/io/text/parse_number.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>

namespace {

using pcm::text::parse_number;

// Every multiple of a quarter near zero and near both ends of the type's range, in three ways.
template <class T>
void try_around_the_range()
{
    constexpr std::int64_t low = std::numeric_limits<T>::min(), high = std::numeric_limits<T>::max();
    for (const std::int64_t middle : {low, std::int64_t(0), high})
        for (std::int64_t quarters = 4 * middle - 9; quarters <= 4 * middle + 9; ++quarters) {
            const double real = static_cast<double>(quarters) / 4;
            const bool holds =
                quarters % 4 == 0 && real >= static_cast<double>(low) && real <= static_cast<double>(high);
            for (const char* format : {"%.2f", "%.17g", "%.17e"}) {
                char word[40];
                std::snprintf(word, sizeof word, format, real);
                T value = 77;
                ASSERT_EQ(parse_number(word, value), holds) << word;
                ASSERT_EQ(value, holds ? static_cast<T>(quarters / 4) : value) << word;
            }
        }
}

TEST(ParseNumber, RealsThatAreWholeAndInTheRangeAreIntegers)
{
    try_around_the_range<std::int8_t>();
    try_around_the_range<std::uint8_t>();
    try_around_the_range<std::int16_t>();
    try_around_the_range<std::uint16_t>();
    try_around_the_range<std::int32_t>();
    try_around_the_range<std::uint32_t>();
}

TEST(ParseNumber, TheEndsOfTypesThatDoublesDoNotHold)
{
    const auto holds = [](const std::string& word, auto value) { return parse_number(word, value); };
    EXPECT_FALSE(holds("-1.0", std::uint64_t()));
    EXPECT_TRUE(holds("9223372036854775807", std::int64_t()));
    EXPECT_TRUE(holds("9223372036854774784.0", std::int64_t()));  // the largest double below
    EXPECT_FALSE(holds("9223372036854775808.0", std::int64_t()));
    EXPECT_TRUE(holds("18446744073709549568.0", std::uint64_t()));
    EXPECT_FALSE(holds("18446744073709551616.0", std::uint64_t()));
}

}  // namespace
