#include "pcm/gl/style/colour_modes.h"

#include "pcm/gl/style/chunk_look.h"
#include "pcm/gl/style/splat_style.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

using namespace pcm;

namespace {

Schema schema_of(const std::vector<Attribute>& attributes)
{
    Schema schema;
    for (const Attribute& attribute : attributes) schema.add(attribute);
    return schema;
}

}  // namespace

TEST(ColourModes, RowsAreInTheOrderOfTheEnumeratorsAndNamesAreUnique)
{
    std::set<std::string> names, labels;
    for (std::size_t i = 0; i < colour_modes().size(); ++i) {
        const ColourTraits& row = colour_modes()[i];
        EXPECT_EQ(static_cast<std::size_t>(row.mode), i) << row.name;
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_TRUE(labels.insert(row.label).second) << row.label;
        EXPECT_STRNE(row.description, "") << row.name;
        EXPECT_EQ(row.colouring == Colouring::chunk, row.of_chunk != nullptr) << row.name;
        const bool reads = row.colouring == Colouring::vertex || row.colouring == Colouring::value ||
                           row.colouring == Colouring::shaded_height;
        EXPECT_EQ(reads, row.source != ColourSource::none) << row.name;
        EXPECT_EQ(row.colouring == Colouring::value || row.colouring == Colouring::shaded_height, is_value(row.source))
            << row.name;
        if (reads) EXPECT_STRNE(row.absent, "") << row.name;
    }
    EXPECT_EQ(static_cast<int>(ColourMode::uniform), 6);  // MeshLab stores the number
    EXPECT_EQ(static_cast<int>(ColourMode::attribute), 7);
    EXPECT_EQ(static_cast<int>(ColourMode::height_intensity), 8);
}

TEST(ColourModes, WhatACloudLacksIsReplacedAndNamed)
{
    const auto usable = [](ColourMode mode, const std::vector<Attribute>& attributes) {
        CloudStyle style;
        style.colour = mode;
        std::string notice;
        const ColourMode shown = usable_style(style, schema_of(attributes), &notice).colour;
        return std::string(name_of(shown)) + " | " + notice;
    };
    const Attribute rgb{"rgb", ScalarType::u8, 3}, grey{"rgb", ScalarType::u8, 1};
    const Attribute intensity{"intensity", ScalarType::u16};
    EXPECT_EQ(usable(ColourMode::rgb, {rgb}), "rgb | ");
    const Attribute classes{"classification", ScalarType::u8};
    EXPECT_EQ(usable(ColourMode::rgb, {intensity}),
              "height-intensity | the cloud has no colours: height-intensity is shown");
    EXPECT_EQ(usable(ColourMode::rgb, {intensity, classes}),
              "classification | the cloud has no colours: classification is shown");
    EXPECT_EQ(usable(ColourMode::rgb, {grey}),
              "height | the cloud has no colours, the cloud has no intensity: height is shown");
    EXPECT_EQ(usable(ColourMode::intensity, {rgb}), "height | the cloud has no intensity: height is shown");
    EXPECT_EQ(usable(ColourMode::classification, {intensity}),
              "height-intensity | the cloud has no classes: height-intensity is shown");
    for (const ColourMode mode : {ColourMode::height, ColourMode::level, ColourMode::error, ColourMode::uniform})
        EXPECT_EQ(usable(mode, {}), std::string(name_of(mode)) + " | ");
}

TEST(ColourModes, AttributesAreNamedByComponent)
{
    CloudStyle style;
    style.colour = ColourMode::attribute;
    style.attribute = "rgb[2]";
    std::string notice;
    const Schema schema = schema_of({{"gps_time", ScalarType::f64, 1}, {"rgb", ScalarType::u8, 3}});
    EXPECT_EQ(usable_style(style, schema, &notice).colour, ColourMode::attribute);
    EXPECT_EQ(*colour_place(style, schema), (AttributePlace{1, 2}));
    style.attribute = "rgb[3]";
    style.range = ValueRange{1, 2, 1};
    const CloudStyle shown = usable_style(style, schema, &notice);
    EXPECT_EQ(shown.colour, ColourMode::height);
    EXPECT_FALSE(shown.range);  // it was of the attribute
    EXPECT_EQ(notice,
              "the cloud has no attribute 'rgb[3]' (attributes: gps_time, rgb[0], rgb[1], rgb[2]): height is shown");
    style.attribute.clear();
    usable_style(style, {}, &notice);
    EXPECT_EQ(notice, "no attribute is named: height is shown");
}

TEST(ColourModes, StylesAreEqualInAllTheirMembers)
{
    CloudStyle style;
    EXPECT_EQ(style, CloudStyle{});
    style.attribute = "a";
    EXPECT_NE(style, CloudStyle{});
    style = {};
    style.ramp = ColourRamp::grey;
    EXPECT_NE(style, CloudStyle{});
    style = {};
    style.range = ValueRange{};
    EXPECT_NE(style, CloudStyle{});
    style = {};
    style.where = {parse_condition("z>1")};
    EXPECT_NE(style, CloudStyle{});
    CloudStyle other = style;
    EXPECT_EQ(style, other);
    other.where = {parse_condition("z>2")};
    EXPECT_NE(style, other);
}
