#include "pcm/gl/l1/vertex_format.h"
#include "pcm/view/vertex_discs.h"

#include "pcm/gl/l1/l1_cache.h"
#include "tests/columns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

using namespace pcm;

TEST(VertexFormat, StridesDivideThePageAndMembersDoNotOverlap)
{
    std::set<unsigned> numbers;
    for (unsigned colour = 0; colour < 4; ++colour)
        for (const bool radius : {false, true})
            for (const bool normal : {false, true}) {
                const VertexFormat format{static_cast<ColourSource>(colour), radius, normal};
                numbers.insert(format.number());
                EXPECT_LT(format.number(), (L1Table<int, L1Container::hash_map>::max_forms));
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
                EXPECT_EQ(format.serves({ColourSource::rgb, false, false}), colour == 1);
                EXPECT_EQ(format.serves({ColourSource::none, true, true}), radius && normal);
            }
    EXPECT_EQ(numbers.size(), 16u);
}

TEST(VertexFormat, AStyleUploadsWhatItReadsAndNothingElse)
{
    CloudStyle style;
    EXPECT_EQ(format_of(style), (VertexFormat{ColourSource::rgb, true, false, true}));
    EXPECT_EQ(format_of(style).stride(), 20u) << "shapes are in the radii";
    style.splats = SplatMode::constant;
    EXPECT_EQ(format_of(style), (VertexFormat{ColourSource::rgb, false, false}));
    style.colour = ColourMode::height;
    EXPECT_EQ(format_of(style).stride(), 12u);
    style.splats = SplatMode::adaptive;
    EXPECT_EQ(format_of(style), (VertexFormat{ColourSource::none, true, false}));
    EXPECT_EQ(format_of(style).stride(), 16u);
    style.colour = ColourMode::classification;
    EXPECT_EQ(format_of(style).stride(), 20u);
    style.splats = SplatMode::affine;
    EXPECT_EQ(format_of(style), (VertexFormat{ColourSource::classification, true, true}));
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

TEST(VertexFormat, VerticesOfAnotherAttributeOrOtherConditionsDoNotServe)
{
    VertexFormat has{ColourSource::attribute, true, false};
    has.attribute = 1;
    has.filter = 2;
    VertexFormat wanted = has;
    EXPECT_TRUE(has.serves(wanted));
    EXPECT_EQ(has, wanted);
    wanted.attribute = 2;
    EXPECT_FALSE(has.serves(wanted));
    EXPECT_NE(has, wanted);
    wanted.colour = ColourSource::none;  // any colour will do
    EXPECT_TRUE(has.serves(wanted));
    wanted = has;
    wanted.filter = 0;
    EXPECT_FALSE(has.serves(wanted));
    EXPECT_NE(has, wanted);
    wanted.colour = ColourSource::none;  // but not other points
    EXPECT_FALSE(has.serves(wanted));
}
