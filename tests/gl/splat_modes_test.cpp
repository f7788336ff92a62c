#include "pcm/gl/style/splat_modes.h"

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

TEST(SplatModes, RowsAreInTheOrderOfTheEnumeratorsAndNamesAreUnique)
{
    std::set<std::string> names, labels, defines;
    for (std::size_t i = 0; i < splat_modes().size(); ++i) {
        const SplatTraits& row = splat_modes()[i];
        EXPECT_EQ(static_cast<std::size_t>(row.mode), i) << row.name;
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_TRUE(labels.insert(row.label).second) << row.label;
        EXPECT_TRUE(defines.insert(row.define).second) << row.define;
        EXPECT_STRNE(row.description, "") << row.name;
    }
    // Scripts, and the settings that MeshLab stores by number.
    EXPECT_STREQ(splat_modes()[0].name, "constant");
    EXPECT_STREQ(splat_modes()[1].name, "adaptive");
    EXPECT_STREQ(splat_modes()[2].name, "affine");
    EXPECT_STREQ(splat_modes()[3].name, "perspective");
    EXPECT_EQ(static_cast<int>(SplatMode::perspective), 3);
    EXPECT_STREQ(splat_modes()[4].name, "fitted");
}

TEST(SplatModes, AShapeReadsWhatItIsMadeOf)
{
    for (const SplatTraits& row : splat_modes()) {
        EXPECT_TRUE(row.shape == SplatShape::pixels || row.reads_radius) << row.name;
        EXPECT_EQ(row.shape == SplatShape::disc, row.reads_normal) << row.name;
        EXPECT_EQ(traits_of(row.in_parallel).shape, row.shape) << row.name;
        EXPECT_EQ(traits_of(row.in_parallel).in_parallel, row.in_parallel) << row.name;
    }
}

TEST(SplatModes, TheNearestModeReadsOnlyWhatIsThere)
{
    for (const SplatTraits& row : splat_modes())
        for (const bool radius : {false, true})
            for (const bool normal : {false, true})
                for (const bool shape : {false, true}) {
                    const SplatTraits& drawn = traits_of(drawable_mode(row.mode, radius, normal, shape));
                    EXPECT_TRUE(radius || !drawn.reads_radius) << row.name;
                    EXPECT_TRUE(normal || !drawn.reads_normal) << row.name;
                    EXPECT_TRUE(shape || !drawn.reads_shape) << row.name;
                    if ((radius || !row.reads_radius) && (normal || !row.reads_normal) && (shape || !row.reads_shape))
                        EXPECT_EQ(drawn.mode, row.mode);
                }
    EXPECT_EQ(drawable_mode(SplatMode::fitted, true, false, false), SplatMode::adaptive);
    EXPECT_EQ(drawable_mode(SplatMode::fitted, true, true, false), SplatMode::adaptive);
    EXPECT_EQ(drawable_mode(SplatMode::perspective, true, false), SplatMode::adaptive);
    EXPECT_EQ(drawable_mode(SplatMode::perspective, false, true), SplatMode::constant);
    EXPECT_EQ(drawable_mode(SplatMode::affine, false, false), SplatMode::constant);
    EXPECT_EQ(drawable_mode(SplatMode::adaptive, false, true), SplatMode::constant);
}

TEST(SplatModes, TheNoticeNamesWhatTheCloudLacks)
{
    const auto notice_of = [](SplatMode mode, const std::vector<Attribute>& attributes) {
        CloudStyle style;
        style.splats = mode;
        style.colour = ColourMode::uniform;
        std::string notice;
        usable_style(style, schema_of(attributes), &notice);
        return notice;
    };
    const Attribute radius{"radius", ScalarType::f32}, normal{"normal", ScalarType::f32, 3};
    EXPECT_EQ(notice_of(SplatMode::perspective, {radius, normal}), "");
    EXPECT_EQ(notice_of(SplatMode::constant, {}), "");
    EXPECT_EQ(notice_of(SplatMode::perspective, {radius}), "the cloud has no normals: adaptive splats are drawn");
    // Every point has a size, which stands for a radius.
    EXPECT_EQ(notice_of(SplatMode::affine, {normal}), "");
    EXPECT_EQ(notice_of(SplatMode::affine, {}), "the cloud has no normals: adaptive splats are drawn");
    EXPECT_EQ(notice_of(SplatMode::adaptive, {}), "");
}
