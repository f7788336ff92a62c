#include "pcm/view/point_colours.h"

#include "tests/columns.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

using namespace pcm;

TEST(PointColours, EveryTypeFillsTheRange)
{
    const auto scaled = [](const Column& column, ColourSource colour) {
        std::vector<std::uint8_t> rgba;
        make_colours(column, ColourScale::of(column, colour), rgba);
        return rgba;
    };
    using Bytes = std::vector<std::uint8_t>;
    EXPECT_EQ(scaled(column_of<std::uint8_t>(ScalarType::u8, 3, {0, 128, 255}), ColourSource::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<std::uint8_t>(ScalarType::u8, 3, {0, 1, 2}), ColourSource::rgb), (Bytes{0, 1, 2, 255}));
    EXPECT_EQ(scaled(column_of<std::uint16_t>(ScalarType::u16, 3, {0, 128 * 257, 65535}), ColourSource::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<std::uint16_t>(ScalarType::u16, 3, {0, 128, 255}), ColourSource::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<float>(ScalarType::f32, 3, {0.0f, 0.5f, 1.0f}), ColourSource::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<double>(ScalarType::f64, 3, {0.0, 128.0, 255.0}), ColourSource::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<float>(ScalarType::f32, 3, {std::nanf(""), -4.0f, 1.0f}), ColourSource::rgb),
              (Bytes{0, 0, 255, 255}));

    const auto grey = scaled(column_of<std::int16_t>(ScalarType::i16, 1, {-300, 0, 300}), ColourSource::intensity);
    EXPECT_EQ(grey[0], 0);
    EXPECT_NEAR(grey[4], 128, 1);
    EXPECT_EQ(grey[8], 255);
    EXPECT_EQ(grey[8], grey[9]);
    const auto flat = scaled(column_of<std::uint16_t>(ScalarType::u16, 1, {7, 7}), ColourSource::intensity);
    EXPECT_EQ(flat, (Bytes{255, 255, 255, 255, 255, 255, 255, 255}));

    // One hot pixel does not darken the rest.
    std::vector<float> values(1000);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
    values[500] = 1e30f;
    const auto robust = scaled(column_of<float>(ScalarType::f32, 1, values), ColourSource::intensity);
    EXPECT_GT(robust[4 * 990], 240);
}

// People know them, and pictures are compared with older ones.
TEST(PointColours, TheColoursOfClassesStay)
{
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a
    for (int number = -1; number <= 256; ++number)
        for (const std::uint8_t channel : class_colour(number)) hash = (hash ^ channel) * 1099511628211u;
    EXPECT_EQ(hash, 9223515678858875923u);
    EXPECT_EQ(class_colour(1.4), class_colour(1));
    EXPECT_EQ(class_colour(1.5), class_colour(2));
    EXPECT_EQ(class_colour(-0.5), class_colour(0));
    EXPECT_EQ(class_colour(255.6), class_colour(-1));
}

TEST(PointColours, EveryClassHasAColour)
{
    std::vector<std::uint8_t> rgba;
    make_class_colours(column_of<std::uint8_t>(ScalarType::u8, 1, {2, 9, 255}), {"classification", ScalarType::u8},
                       rgba);
    const auto colour = [&](std::size_t p) {
        return std::array<std::uint8_t, 3>{rgba[4 * p], rgba[4 * p + 1], rgba[4 * p + 2]};
    };
    EXPECT_EQ(colour(0), class_colour(2));
    EXPECT_EQ(colour(1), class_colour(9));
    EXPECT_EQ(colour(2), class_colour(255));
    EXPECT_EQ(rgba[3], 255);
    make_class_colours(column_of<float>(ScalarType::f32, 1, {std::nanf(""), -1, 300, 2}),
                       {"classification", ScalarType::f32}, rgba);
    for (std::size_t p = 0; p < 3; ++p) EXPECT_EQ(colour(p), (std::array<std::uint8_t, 3>{255, 0, 255}));
    EXPECT_EQ(colour(3), class_colour(2));
    std::set<std::array<std::uint8_t, 3>> different;
    for (int c = 0; c <= 18; ++c) different.insert(class_colour(c));
    EXPECT_EQ(different.size(), 19u);
    for (int c = 19; c < 255; ++c) EXPECT_NE(class_colour(c), class_colour(c + 1));
}
