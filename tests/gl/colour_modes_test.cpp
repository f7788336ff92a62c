#include "pcm/gl/colour_modes.h"

#include "pcm/gl/chunk_look.h"
#include "pcm/gl/splat_style.h"

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
        EXPECT_EQ(row.colouring == Colouring::vertex, row.source != ColourSource::none) << row.name;
        if (row.colouring == Colouring::vertex) EXPECT_STRNE(row.absent, "") << row.name;
    }
    EXPECT_EQ(static_cast<int>(ColourMode::uniform), 6);  // MeshLab stores the number
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
    EXPECT_EQ(usable(ColourMode::rgb, {intensity}), "intensity | the cloud has no colours: intensity is shown");
    EXPECT_EQ(usable(ColourMode::rgb, {grey}),
              "height | the cloud has no colours: intensity is shown; the cloud has no intensity: height is shown");
    EXPECT_EQ(usable(ColourMode::classification, {rgb}), "height | the cloud has no classes: height is shown");
    for (const ColourMode mode : {ColourMode::height, ColourMode::level, ColourMode::error, ColourMode::uniform})
        EXPECT_EQ(usable(mode, {}), std::string(name_of(mode)) + " | ");
}

TEST(ColourModes, TheRampIsClampedAndContinuous)
{
    EXPECT_EQ(ramp_colour(-1), ramp_colour(0));
    EXPECT_EQ(ramp_colour(2), ramp_colour(1));
    for (float t = 0; t < 1; t += 0.001f)
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(ramp_colour(t)[c], ramp_colour(t + 0.001f)[c], 0.004);
}
