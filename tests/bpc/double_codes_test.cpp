#include "pcm/bpc/double_codes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace {

std::uint64_t bits_of(double v)
{
    std::uint64_t bits;
    std::memcpy(&bits, &v, 8);
    return bits;
}
double from_bits(std::uint64_t bits)
{
    double v;
    std::memcpy(&v, &bits, 8);
    return v;
}

// Codes and decodes, in 64 bits and where they fit in 32, and returns bits between the smallest and the largest code.
int coded(const std::vector<double>& values, pcm::DoubleCodes& codes, std::size_t axis = 1)
{
    std::vector<std::int64_t> to(values.size());
    pcm::code_doubles(values.data(), values.size(), axis, codes, to.data());
    const auto [low, high] = std::minmax_element(to.begin(), to.end());
    const std::uint64_t span = static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low);
    std::vector<std::uint64_t> wide;
    std::vector<std::uint32_t> narrow;
    for (const std::int64_t c : to) {
        wide.push_back(static_cast<std::uint64_t>(c) - static_cast<std::uint64_t>(*low));
        narrow.push_back(static_cast<std::uint32_t>(wide.back()));
    }
    std::vector<double> back(values.size());
    pcm::decode_doubles(codes, axis, *low, wide.data(), wide.size(), back.data());
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(bits_of(back[i]), bits_of(values[i])) << values[i];
    if (span <= 0xffffffffu) {
        pcm::decode_doubles(codes, axis, *low, narrow.data(), narrow.size(), back.data());
        for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(bits_of(back[i]), bits_of(values[i])) << values[i];
    }
    for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_EQ(bits_of(codes.to_source(to[i], axis)), bits_of(values[i]));
    return span ? 64 - __builtin_clzll(span) : 0;
}

TEST(DoubleCodes, DecimalsTakeTheirDigits)
{
    std::mt19937_64 random(1);
    for (int digits = 0; digits <= 9; ++digits) {
        std::vector<double> values;
        for (int i = 0; i < 1000; ++i) {  // parsed from text, as a reader does
            std::string text = std::to_string(random() % 1000000);
            if (digits) {
                std::string fraction =
                    std::to_string(random() % 1000000000 + 1000000000).substr(1, std::size_t(digits));
                text += "." + fraction;
            }
            values.push_back(std::stod((random() % 2 ? "-" : "") + text));
        }
        values.push_back(digits ? 0.1 : 1);
        pcm::DoubleCodes codes;
        const int bits = coded(values, codes);
        EXPECT_EQ(codes.divisor[1], std::pow(10.0, digits));
        EXPECT_LE(bits, 21 + std::ceil(digits * std::log2(10.0)) + 1);
    }
}

TEST(DoubleCodes, AGridOfAPowerOfTwo)
{
    std::mt19937_64 random(2);
    for (const int exponent : {-900, -20, 0, 7, 900}) {
        std::vector<double> values{std::ldexp(1.0, exponent)};
        for (int i = 0; i < 1000; ++i)
            values.push_back(
                std::ldexp(static_cast<double>(static_cast<std::int64_t>(random() % 200001) - 100000), exponent));
        for (double& v : values) v += 0.0;  // no -0
        values.push_back(0);                // a multiple of any step
        pcm::DoubleCodes codes;
        EXPECT_EQ(coded(values, codes), 18);
        EXPECT_GT(codes.divisor[1], 0);
        values.back() = -0.0;  // no quotient gives it back
        coded(values, codes);
        EXPECT_EQ(codes.divisor[1], 0);
    }
}

TEST(DoubleCodes, FloatsTakeNoMoreThanTheirBits)
{
    std::mt19937_64 random(3);
    std::vector<double> values;
    for (int i = 0; i < 1000; ++i)
        values.push_back(static_cast<double>(static_cast<float>(random()) * (random() % 2 ? 1e-30f : -1e10f)));
    pcm::DoubleCodes codes;
    EXPECT_LE(coded(values, codes), 35);
    EXPECT_EQ(codes.divisor[1], 0);
    EXPECT_GE(codes.shift[1], 29u);
}

TEST(DoubleCodes, EveryBitPatternSurvives)
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    const std::vector<double> special{0.0,
                                      -0.0,
                                      1.0,
                                      -1.0,
                                      nan,
                                      -nan,
                                      inf,
                                      -inf,
                                      1e9,
                                      1e-300,
                                      5e-324,
                                      -5e-324,
                                      1.7976931348623157e308,
                                      0.1,
                                      from_bits(0x7ff0000000000001),
                                      from_bits(0xfff8dead0000beef),
                                      9007199254740993.0};
    std::mt19937_64 random(4);
    for (const double one : special) {
        pcm::DoubleCodes codes;
        coded({one}, codes, random() % 3);
        coded({one, one}, codes, random() % 3);
        for (const double other : special) coded({one, other}, codes, random() % 3);
    }
    for (int round = 0; round < 300; ++round) {
        std::vector<double> values;
        for (std::size_t i = 0; i < 1 + random() % 50; ++i)
            values.push_back(random() % 3 ? from_bits(random()) : special[random() % special.size()]);
        pcm::DoubleCodes codes;
        coded(values, codes, random() % 3);
    }
}

TEST(DoubleCodes, ImpossibleHeadersAreRefused)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(pcm::DoubleCodes::checked({0, 1, 1e3}, {63, 0, 0}));
    EXPECT_FALSE(pcm::DoubleCodes::checked({-1, 1, 1}, {0, 0, 0}));
    EXPECT_FALSE(pcm::DoubleCodes::checked({1, nan, 1}, {0, 0, 0}));
    EXPECT_FALSE(pcm::DoubleCodes::checked({1, 1, 1.0 / 0.0}, {0, 0, 0}));
    EXPECT_FALSE(pcm::DoubleCodes::checked({0, 0, 0}, {64, 0, 0}));
    EXPECT_FALSE(pcm::DoubleCodes::checked({0, 0, 0}, {0, 0.5, 0}));
    EXPECT_FALSE(pcm::DoubleCodes::checked({0, 0, 0}, {0, -1, 0}));
    EXPECT_FALSE(pcm::DoubleCodes::checked({0, 0, 0}, {0, 0, nan}));
}

}  // namespace
