#include "pcm/view/value_range.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace pcm;

namespace {

ValueSummary summary_of_values(std::vector<double> values) { return summary_of(values); }

std::vector<double> evenly(std::size_t count, double low, double high)
{
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1));
    return values;
}

}  // namespace

TEST(ValueRange, ExtremeValuesAreOutsideOfIt)
{
    std::vector<double> values = evenly(1001, 100, 200);
    values[3] = 1e9;
    values[700] = -1e9;
    values[10] = std::nan("");
    values[11] = std::numeric_limits<double>::infinity();
    const ValueSummary summary = summary_of_values(values);
    EXPECT_EQ(summary.values, 999u);
    EXPECT_EQ(summary.most, 1e9);
    const ValueRange range = linear_range(summary);
    EXPECT_NEAR(range.low, 101, 0.3);
    EXPECT_NEAR(range.high, 199, 0.3);
    EXPECT_EQ(range.exponent, 1);
    // Few values have no extreme one.
    EXPECT_EQ(linear_range(summary_of_values({5, 1, 3})), (ValueRange{1, 5, 1}));
    // Nearly all are equal: those that are not are still seen.
    values.assign(1000, 4);
    values[0] = 1;
    values[999] = 6;
    EXPECT_EQ(linear_range(summary_of_values(values)), (ValueRange{1, 6, 1}));
    // All are equal, or there are none: the one is in the middle.
    EXPECT_TRUE(summary_of_values({7, 7}).is_constant());
    EXPECT_EQ(linear_range(summary_of_values({7, 7})).place_of(7), 0.5);
    EXPECT_EQ(linear_range(summary_of_values({3e15, 3e15})).place_of(3e15), 0.5);
    EXPECT_TRUE(summary_of_values({}).is_constant());
    EXPECT_TRUE(summary_of_values({std::nan("")}).is_constant());
}

TEST(ValueRange, ABalancedOneMovesTheMedianTowardsTheMiddle)
{
    std::vector<double> values = evenly(1000, 0, 10);
    for (std::size_t i = 900; i < 1000; ++i) values[i] = 10 + 0.3 * static_cast<double>(i - 900);
    const ValueSummary dark = summary_of_values(values);
    const ValueRange range = balanced_range(dark);
    EXPECT_LT(linear_range(dark).place_of(dark.median), 0.2);
    EXPECT_NEAR(range.place_of(dark.median), 0.4, 1e-9);
    EXPECT_EQ(range.place_of(range.low), 0);
    EXPECT_EQ(range.place_of(range.high), 1);
    for (const double place : {0.0, 0.2, 0.5, 1.0}) EXPECT_NEAR(range.place_of(range.value_at(place)), place, 1e-12);
    // What is balanced stays.
    EXPECT_EQ(balanced_range(summary_of_values(evenly(1000, 0, 10))).exponent, 1);
}

TEST(ValueRange, AsUsersWriteIt)
{
    EXPECT_EQ(parse_value_range("0:255"), (ValueRange{0, 255, 1}));
    EXPECT_EQ(parse_value_range("-2.5:+1e3"), (ValueRange{-2.5, 1000, 1}));
    for (const char* wrong : {"", "1", "1:", ":1", "2:1", "1:1", "a:b", "1:2:3", "nan:1", "0:inf", "1 :2"})
        EXPECT_THROW(parse_value_range(wrong), Error) << wrong;
}

TEST(ValueRange, ComponentsOfAttributesHaveNames)
{
    Schema schema;
    schema.add({"time", ScalarType::f64});
    schema.add({"rgb", ScalarType::u8, 3});
    schema.add({"odd[1]", ScalarType::u8});
    EXPECT_EQ(*place_of(schema, "time"), (AttributePlace{0, 0}));
    EXPECT_EQ(*place_of(schema, "time[0]"), (AttributePlace{0, 0}));
    EXPECT_EQ(*place_of(schema, "rgb[2]"), (AttributePlace{1, 2}));
    EXPECT_EQ(*place_of(schema, "odd[1]"), (AttributePlace{2, 0}));
    for (const char* wrong : {"", "rgb", "rgb[3]", "rgb[]", "rgb[x]", "rgb[0", "[0]", "times"})
        EXPECT_FALSE(place_of(schema, wrong)) << wrong;
    const std::vector<std::string> names = component_names(schema);
    EXPECT_EQ(names, (std::vector<std::string>{"time", "rgb[0]", "rgb[1]", "rgb[2]", "odd[1]"}));
    for (const std::string& name : names) EXPECT_TRUE(place_of(schema, name)) << name;
}
