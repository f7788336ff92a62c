#include "pcm/gl/vertex_format.h"
#include "pcm/gl/vertex_colours.h"
#include "pcm/gl/vertex_discs.h"

#include "pcm/gl/l1_cache.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <set>

using namespace pcm;

namespace {

template <class T>
Column column_of(ScalarType type, std::uint32_t components, const std::vector<T>& values)
{
    Column column(type, components);
    column.resize(values.size() / components);
    std::memcpy(column.data(), values.data(), values.size() * sizeof(T));
    return column;
}

}  // namespace

TEST(VertexFormat, StridesDivideThePageAndMembersDoNotOverlap)
{
    std::set<unsigned> numbers;
    for (unsigned colour = 0; colour < 4; ++colour)
        for (const bool radius : {false, true})
            for (const bool normal : {false, true}) {
                const VertexFormat format{static_cast<VertexColour>(colour), radius, normal};
                numbers.insert(format.number());
                EXPECT_LT(format.number(), 16u);
                EXPECT_EQ(L1Cache::page_bytes % format.stride(), 0u);
                std::set<std::uint32_t> bytes;
                std::size_t sum = 0;
                const auto take = [&](std::uint32_t place, std::uint32_t size) {
                    for (std::uint32_t b = place; b < place + size; ++b) bytes.insert(b);
                    sum += size;
                };
                take(0, 12);
                if (colour) take(VertexFormat::colour_place, 4);
                if (radius) take(format.radius_place(), 4);
                if (normal) take(VertexFormat::normal_place, 12);
                EXPECT_EQ(bytes.size(), sum);
                EXPECT_LT(*bytes.rbegin(), format.stride());
                EXPECT_TRUE(format.serves({}));
                EXPECT_TRUE(format.serves(format));
                EXPECT_EQ(format.serves({VertexColour::rgb, false, false}), colour == 1);
                EXPECT_EQ(format.serves({VertexColour::none, true, true}), radius && normal);
            }
    EXPECT_EQ(numbers.size(), 16u);
}

TEST(VertexFormat, AStyleUploadsWhatItReadsAndNothingElse)
{
    CloudStyle style;
    EXPECT_EQ(format_of(style), (VertexFormat{VertexColour::rgb, false, false}));
    style.colour = ColourMode::height;
    EXPECT_EQ(format_of(style).stride(), 12u);
    style.splats = SplatMode::dynamic;
    EXPECT_EQ(format_of(style), (VertexFormat{VertexColour::none, true, false}));
    EXPECT_EQ(format_of(style).stride(), 16u);
    style.colour = ColourMode::classification;
    EXPECT_EQ(format_of(style).stride(), 20u);
    style.splats = SplatMode::affine;
    EXPECT_EQ(format_of(style), (VertexFormat{VertexColour::classification, true, true}));
    style.splats = SplatMode::perspective;
    EXPECT_EQ(format_of(style).stride(), 32u);
}

TEST(VertexDiscs, RadiiOfAnyTypeWithScaleAndOffset)
{
    std::vector<float> radii;
    EXPECT_EQ(make_radii(column_of<std::uint16_t>(ScalarType::u16, 1, {0, 10, 400}),
                         {"radius", ScalarType::u16, 1, 0.001, 0.5}, radii),
              0.9f);
    EXPECT_EQ(radii, (std::vector<float>{0.5f, 0.51f, 0.9f}));
    const double nan = std::nan("");
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_EQ(make_radii(column_of<double>(ScalarType::f64, 1, {nan, -1, infinite, -infinite, 0, 2, 1e300}),
                         {"radius", ScalarType::f64}, radii),
              largest_vertex_radius);
    EXPECT_EQ(radii, (std::vector<float>{0, 0, 0, 0, 0, 2, largest_vertex_radius}));
    EXPECT_EQ(
        make_radii(column_of<std::int8_t>(ScalarType::i8, 1, {-5, 5}), {"radius", ScalarType::i8, 1, 1, 0}, radii), 5);
    EXPECT_EQ(radii, (std::vector<float>{0, 5}));
    EXPECT_EQ(make_radii(Column(ScalarType::f32, 1), {"radius", ScalarType::f32}, radii), 0);
}

TEST(VertexDiscs, NormalsHaveLengthOneOrZero)
{
    std::vector<float> normals;
    const float nan = std::nanf("");
    make_normals(
        column_of<float>(ScalarType::f32, 3, {0, 0, 5, 3, 4, 0, 0, 0, 0, nan, 1, 0, 1e30f, 0, 0, 0, 1e-30f, 0}),
        {"normal", ScalarType::f32, 3}, normals);
    EXPECT_EQ(normals, (std::vector<float>{0, 0, 1, 0.6f, 0.8f, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0}));
    make_normals(column_of<std::int8_t>(ScalarType::i8, 3, {0, -127, 0, 127, 0, 0}),
                 {"normal", ScalarType::i8, 3, 1.0 / 127, 0}, normals);
    EXPECT_EQ(normals, (std::vector<float>{0, -1, 0, 1, 0, 0}));
    make_normals(
        column_of<double>(ScalarType::f64, 3, {1e300, 1e300, 0, std::numeric_limits<double>::infinity(), 0, 0}),
        {"normal", ScalarType::f64, 3}, normals);
    EXPECT_FLOAT_EQ(normals[0], static_cast<float>(std::sqrt(0.5)));
    EXPECT_EQ(normals[3], 0);
}

TEST(VertexColours, EveryTypeFillsTheRange)
{
    const auto scaled = [](const Column& column, VertexColour colour) {
        std::vector<std::uint8_t> rgba;
        make_colours(column, ColourScale::of(column, colour), rgba);
        return rgba;
    };
    using Bytes = std::vector<std::uint8_t>;
    EXPECT_EQ(scaled(column_of<std::uint8_t>(ScalarType::u8, 3, {0, 128, 255}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<std::uint8_t>(ScalarType::u8, 3, {0, 1, 2}), VertexColour::rgb), (Bytes{0, 1, 2, 255}));
    EXPECT_EQ(scaled(column_of<std::uint16_t>(ScalarType::u16, 3, {0, 128 * 257, 65535}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<std::uint16_t>(ScalarType::u16, 3, {0, 128, 255}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<float>(ScalarType::f32, 3, {0.0f, 0.5f, 1.0f}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<double>(ScalarType::f64, 3, {0.0, 128.0, 255.0}), VertexColour::rgb),
              (Bytes{0, 128, 255, 255}));
    EXPECT_EQ(scaled(column_of<float>(ScalarType::f32, 3, {std::nanf(""), -4.0f, 1.0f}), VertexColour::rgb),
              (Bytes{0, 0, 255, 255}));

    const auto grey = scaled(column_of<std::int16_t>(ScalarType::i16, 1, {-300, 0, 300}), VertexColour::intensity);
    EXPECT_EQ(grey[0], 0);
    EXPECT_NEAR(grey[4], 128, 1);
    EXPECT_EQ(grey[8], 255);
    EXPECT_EQ(grey[8], grey[9]);
    const auto flat = scaled(column_of<std::uint16_t>(ScalarType::u16, 1, {7, 7}), VertexColour::intensity);
    EXPECT_EQ(flat, (Bytes{255, 255, 255, 255, 255, 255, 255, 255}));

    // One hot pixel does not darken the rest.
    std::vector<float> values(1000);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
    values[500] = 1e30f;
    const auto robust = scaled(column_of<float>(ScalarType::f32, 1, values), VertexColour::intensity);
    EXPECT_GT(robust[4 * 990], 240);
}

TEST(VertexColours, EveryClassHasAColour)
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
