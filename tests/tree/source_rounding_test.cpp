#include "pcm/tree/source_rounding.h"

#include "pcm/bpc/byte_order.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <random>
#include <string>

namespace {

using namespace pcm;

int places_of(const std::vector<double>& values)
{
    DecimalCount count;
    for (const double v : values) count.see(v);
    return count.places();
}

TEST(DecimalCount, CountsTheDigitsAfterThePoint)
{
    EXPECT_EQ(places_of({}), 0);
    EXPECT_EQ(places_of({0, -0.0, 12, -4800000}), 0);
    EXPECT_EQ(places_of({12, 0.7, 3}), 1);
    EXPECT_EQ(places_of({-0.007, 0.1, 4800000.123}), 3);
    EXPECT_EQ(places_of({1.0 / 3}), no_decimals);
    EXPECT_EQ(places_of({0.1f}), no_decimals);
    EXPECT_EQ(places_of({std::sqrt(2.0) * 1e6}), no_decimals);
    EXPECT_EQ(places_of({1e15, 0.25}), no_decimals);  // 1e17 hundredths: more than the integers of a double
    EXPECT_EQ(places_of({1e300}), no_decimals);
    EXPECT_EQ(places_of({1e-300}), no_decimals);
}

TEST(DecimalCount, TheOrderAndThePartsDoNotMatter)
{
    std::mt19937_64 random(1);
    for (int round = 0; round < 200; ++round) {
        std::vector<double> values;
        for (int i = 0; i < 6; ++i) {
            const int digits = static_cast<int>(random() % 8);
            values.push_back(static_cast<double>(random() % 100000000) / power_of_ten(digits));
        }
        if (round % 5 == 0) values[3] = 1e14 + 0.5;
        const int expected = places_of(values);
        std::shuffle(values.begin(), values.end(), random);
        EXPECT_EQ(places_of(values), expected);
        DecimalCount first, second;
        for (std::size_t i = 0; i < values.size(); ++i) (i % 2 ? first : second).see(values[i]);
        ByteWriter saved;
        second.save(saved);
        ByteReader in(saved.bytes().data(), saved.size(), {});
        first.merge(DecimalCount::load(in));
        EXPECT_EQ(in.left(), 0u);
        EXPECT_EQ(first.places(), expected);
    }
}

TEST(SourceRounding, DecimalsComeBackBitForBit)
{
    std::mt19937_64 random(2);
    for (const int digits : {1, 2, 3, 6, 9})
        for (const double largest : {100.0, 5e6}) {
            const SourceRounding rounding(DecimalPlaces{digits, digits, no_decimals});
            const double step = std::ldexp(largest, -61);
            for (int i = 0; i < 3000; ++i) {
                const auto n = static_cast<std::int64_t>(random() % 2000000) - 1000000;
                const std::string text = std::to_string(n) + "e-" + std::to_string(digits);
                double v = 0;
                std::from_chars(text.data(), text.data() + text.size(), v);
                const double stored = std::nearbyint(v / step) * step;
                EXPECT_EQ(rounding(stored, 0), v);
                EXPECT_EQ(rounding(v, 1), v);
                EXPECT_EQ(rounding(stored, 2), stored);
            }
        }
}

TEST(SourceRounding, ComesWithTheTree)
{
    TreeInfo info;
    EXPECT_FALSE(SourceRounding(info).has_decimals());
    set_decimals(info.metadata, {3, no_decimals, 12});
    ASSERT_EQ(info.metadata.size(), 1u);
    EXPECT_EQ(SourceRounding(info)(Vec3d{0.0070001, 0.0070001, 0.5}), (Vec3d{0.007, 0.0070001, 0.5}));
    info.position_type = ScalarType::i32;  // integers are not rounded
    EXPECT_FALSE(SourceRounding(info).has_decimals());
    info.position_type = ScalarType::f32;
    EXPECT_TRUE(SourceRounding(info).single_precision());
    EXPECT_EQ(SourceRounding(info)(0.1, 0), static_cast<double>(0.1f));
    info.position_type = ScalarType::f64;
    for (const char* text : {"", "a b c", "3", "99 99 99", "-1 -1 -1", "3 3", "16 - -"}) {
        info.metadata[0].value.resize(std::strlen(text));
        std::memcpy(info.metadata[0].value.data(), text, std::strlen(text));
        for (const double v : {0.123456789, -7e30, 0.0}) {
            const Vec3d rounded = SourceRounding(info)(Vec3d{v, v, v});
            EXPECT_TRUE(is_finite(rounded)) << text;
        }
    }
    set_decimals(info.metadata, {no_decimals, no_decimals, no_decimals});
    EXPECT_TRUE(info.metadata.empty());
}

}  // namespace
