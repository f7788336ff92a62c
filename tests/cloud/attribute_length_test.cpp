#include "pcm/cloud/attribute_length.h"

#include <gtest/gtest.h>

namespace pcm::test {
namespace {

int power(const std::string& name, const std::string& description, std::uint32_t components = 1)
{
    return length_power({name, ScalarType::f32, components, 1, 0, description});
}

TEST(AttributeLength, IsWhatTheDescriptionStates)
{
    EXPECT_EQ(power("x", "gap, source units"), 1);
    EXPECT_EQ(power("x", "source units"), 1);
    EXPECT_EQ(power("x", "area, source units^2"), 2);
    EXPECT_EQ(power("x", "points in source units^-3"), -3);
    EXPECT_EQ(power("x", "offset, source units", 3), 1);
    EXPECT_EQ(power("radius", "dimensionless, source units^0"), 0);
    for (const char* other : {"", "gap", "source units of the scanner", "source units^", "source units^-",
                              "source units^12", "source units2", "Source units"})
        EXPECT_EQ(power("x", other), 0) << other;
}

// Attributes of trees that have no descriptions.
TEST(AttributeLength, IsKnownByNameWhereNothingIsStated)
{
    EXPECT_EQ(power("radius", ""), 1);
    EXPECT_EQ(power("mean_distance", ""), 1);
    EXPECT_EQ(power("radius", "of the tree's trunk"), 1);
    EXPECT_EQ(power("radius", "", 3), 0);
    EXPECT_EQ(power("curvature", ""), 0);
    EXPECT_EQ(power("intensity", ""), 0);
}

TEST(AttributeLength, StaysInAShortenedDescription)
{
    EXPECT_EQ(shortened_description("gap, source units", 32), "gap, source units");
    const std::string text = "of the nearest neighbours, source units";
    EXPECT_EQ(shortened_description(text, 32), "of the nearest nei, source units");
    EXPECT_EQ(power("x", shortened_description(text + "^-2", 32)), -2);
    EXPECT_EQ(shortened_description(std::string(40, 'a'), 32), std::string(32, 'a'));
    EXPECT_EQ(shortened_description(std::string(31, 'a') + "\xC3\xA9tude", 32), std::string(31, 'a'));
    EXPECT_LE(shortened_description(std::string(40, 'a') + ", source units^-1", 20).size(), 20u);
}

}  // namespace
}  // namespace pcm::test
