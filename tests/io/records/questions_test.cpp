// What writers ask of a cloud's values before they create a file.

#include "pcm/io/records/stored_values.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm;

Attribute of_type(ScalarType type)
{
    Attribute attribute;
    attribute.name = "value";
    attribute.type = type;
    return attribute;
}

TEST(Questions, OnlyAttributesOf64BitsAreAskedFor)
{
    for (const ScalarType type : {ScalarType::i8, ScalarType::u8, ScalarType::i16, ScalarType::u16, ScalarType::i32,
                                  ScalarType::u32, ScalarType::f32, ScalarType::f64})
        for (const double scale : {1.0, 0.5})
            for (const bool format_has_64_bits : {false, true}) {
                Attribute attribute = of_type(type);
                attribute.scale = scale;
                EXPECT_EQ(question_about(attribute, {}, format_has_64_bits), Question::none) << static_cast<int>(type);
            }
    for (const ScalarType type : {ScalarType::i64, ScalarType::u64}) {
        Attribute attribute = of_type(type);
        EXPECT_EQ(question_about(attribute, {}, true), Question::none);
        EXPECT_EQ(question_about(attribute, {}, false), Question::doubles);
        attribute.offset = 3;
        EXPECT_EQ(question_about(attribute, {}, true), Question::range);
        EXPECT_EQ(question_about(attribute, {}, false), Question::range);
    }
}

TEST(Questions, ColoursAreAskedForUnlessTheyAreOf8BitsOrStayOf16)
{
    Attribute colours = of_type(ScalarType::u16);
    colours.name = attribute_name::rgb;
    EXPECT_EQ(question_about(colours, {}, false), Question::none) << "one component is not a colour";
    colours.components = 3;
    EXPECT_EQ(question_about(colours, {}, false), Question::colour_steps);
    EXPECT_EQ(question_about(colours, 8u, false), Question::colour_steps);
    EXPECT_EQ(question_about(colours, 16u, false), Question::none);
    colours.type = ScalarType::f32;
    EXPECT_EQ(question_about(colours, {}, false), Question::range);
    colours.type = ScalarType::u8;
    EXPECT_EQ(question_about(colours, {}, false), Question::none);
}

}  // namespace
