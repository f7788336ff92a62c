#include "pcm/system/text.h"

#include "pcm/system/counted.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace {

using namespace pcm;

TEST(Text, NumbersForPeople)
{
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1234567), "1,234,567");
    EXPECT_EQ(counted(1, "pipe run"), "1 pipe run");
    EXPECT_EQ(counted(1234, "pipe run"), "1,234 pipe runs");
    EXPECT_EQ(points_text(0), "0 points");
    EXPECT_EQ(points_text(1), "1 point");
    EXPECT_EQ(points_text(1234), "1,234 points");
    EXPECT_EQ(exact(500000), "500000");
    EXPECT_EQ(exact(848935.2000000001), "848935.2000000001");
    EXPECT_EQ(exact(1e-9), "1e-09");
    EXPECT_EQ(bytes_text(999), "999 bytes");
    EXPECT_EQ(bytes_text(1250000000), "1.25 GB");
    for (const double value : {0.1, 1e300, -4.8e6, 2323.0000000000005}) EXPECT_EQ(std::stod(exact(value)), value);
}

TEST(Text, ExactReadsBackAsTheSameDouble)
{
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t bits = random();
        double value;
        std::memcpy(&value, &bits, sizeof value);
        if (i % 2) value = std::ldexp(static_cast<double>(bits % 1000003), static_cast<int>(bits % 40) - 20);
        if (std::isnan(value)) continue;
        const std::string text = exact(value);
        EXPECT_EQ(std::strtod(text.c_str(), nullptr), value) << text;
        const bool everyday = std::fabs(value) >= 1e-6 && std::fabs(value) < 1e15;
        if (everyday) EXPECT_EQ(text.find('e'), std::string::npos) << text;
    }
    EXPECT_EQ(exact(0.0), "0");
    EXPECT_EQ(exact(-0.0), "-0");
    EXPECT_EQ(exact(std::array<double, 3>{1, -2.5, 500000}), "1 -2.5 500000");
}

TEST(Text, GroupsOfThreeDigits)
{
    EXPECT_EQ(grouped(1000), "1,000");
    EXPECT_EQ(grouped(100000), "100,000");
    EXPECT_EQ(grouped(std::numeric_limits<std::uint64_t>::max()), "18,446,744,073,709,551,615");
}

TEST(Text, UnitsOfBytesAndTime)
{
    EXPECT_EQ(bytes_text(0), "0 bytes");
    EXPECT_EQ(bytes_text(1000), "1.00 kB");
    EXPECT_EQ(bytes_text(2500000), "2.50 MB");
    EXPECT_EQ(bytes_text(7000000000000000), "7000.00 TB");
    EXPECT_EQ(time_text(0.0032), "3.2 ms");
    EXPECT_EQ(time_text(2.5), "2.5 s");
    // Never 1000 of a unit, and no exponent.
    EXPECT_EQ(bytes_text(999), "999 bytes");
    EXPECT_EQ(bytes_text(999994), "999.99 kB");
    EXPECT_EQ(bytes_text(999999), "1.00 MB");
    EXPECT_EQ(bytes_text(999999999), "1.00 GB");
    EXPECT_EQ(time_text(0.9994), "999 ms");
    EXPECT_EQ(time_text(0.9996), "1 s");
    EXPECT_EQ(time_text(99.96), "100 s");
    EXPECT_EQ(time_text(119.4), "119 s");
    EXPECT_EQ(time_text(125), "2 min 5 s");
    EXPECT_EQ(time_text(999.9), "16 min 40 s");
    EXPECT_EQ(time_text(3599.6), "1 h 0 min");
    EXPECT_EQ(time_text(12000), "3 h 20 min");
    EXPECT_EQ(time_text(3600.0 * 123456), "123,456 h 0 min");
    EXPECT_EQ(time_text(std::numeric_limits<double>::infinity()), "inf s");
    EXPECT_EQ(brief(0.0123456), "0.0123");
}

}  // namespace
