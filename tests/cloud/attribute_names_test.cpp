// Attributes' names as people write them.
#include "pcm/cloud/attribute_names.h"

#include "pcm/cloud/selection.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using namespace pcm;

std::string refusal_of(const std::string& name)
{
    try {
        check_new_name(name);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "";
}

TEST(AttributeNames, NewOnesCannotBeTakenForSomethingElse)
{
    for (const char* good :
         {"height", "_", "a1", "noise_2", "gps time", "a-b", "a.b", "h\xc3\xb6he", "X", "nano", "e5"})
        EXPECT_EQ(refusal_of(good), "") << good;
    for (const char* bad :
         {"",    "1",   "-5",  "1e5", "nan",  "inf", "NaN", "x",   "y",    "z",    "2nd",  " a",   "a ", "a=b",
          "a<b", "a>b", "a!b", "a,b", "a[0]", "a]",  "a:b", "'a'", "a\"b", "a..b", "a\tb", "a\nb", "$a", "*"})
        EXPECT_NE(refusal_of(bad).find("cannot be called '" + std::string(bad) + "'"), std::string::npos) << bad;
}

TEST(AttributeNames, AsTheyAreWritten)
{
    const auto read = [](const std::string& text) {
        const auto written = written_name(text, "=!<>");
        if (!written) return std::string("open");
        return written->name + (written->quoted ? " (quoted)|" : "|") + text.substr(written->end);
    };
    EXPECT_EQ(read("a=3"), "a|=3");
    EXPECT_EQ(read(" a b <= 3"), "a b|<= 3");
    EXPECT_EQ(read("a"), "a|");
    EXPECT_EQ(read(""), "|");
    EXPECT_EQ(read("'1'>3"), "1 (quoted)|>3");
    EXPECT_EQ(read("\"a=b\" != 3"), "a=b (quoted)|!= 3");
    EXPECT_EQ(read("'it is \"1\"'=2"), "it is \"1\" (quoted)|=2");
    EXPECT_EQ(read("' '=2"), "  (quoted)|=2");
    EXPECT_EQ(read("'a=b'[1]=2"), "a=b[1]|=2");
    for (const char* open : {"'a=3", "\"a'=3", "'a'b=3", "'a'[1=3", "'"}) EXPECT_EQ(read(open), "open") << open;
}

// The cloud has attributes that files may bring. How many points of 0, 1, 2, 3 (each attribute's values times its place
// in the schema, counted from 1) a condition selects.
std::string selected(const std::string& condition)
{
    Schema schema;
    for (const char* name : {"1", "a=b", "x", "nan", "rgb[0]", "a b"}) schema.add({name, ScalarType::f64, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::f64, 3, 1, 0, ""});
    schema.add({"rgb[3]", ScalarType::f64, 1, 1, 0, ""});  // rgb has no such component
    PointBatch batch;
    batch.reset(schema, false, 4);
    for (std::size_t k = 0; k < schema.size(); ++k)
        for (std::size_t i = 0; i < 4 * schema[k].components; ++i)
            batch.attributes[k].as<double>()[i] = static_cast<double>(i / schema[k].components * (k + 1));
    try {
        Selection selection;
        selection.where.push_back(parse_condition(condition));
        Selector(selection, schema).apply(batch, nullptr);
        return std::to_string(batch.size);
    } catch (const Error& error) {
        return error.what();
    }
}

TEST(AttributeNames, AConditionIsNeverMisread)
{
    const auto expect_refused = [](const std::string& condition, const std::string& why) {
        EXPECT_NE(selected(condition).find(why), std::string::npos) << condition << ": " << selected(condition);
    };
    EXPECT_EQ(selected("'1'>1"), "2");
    expect_refused("1>1", "'1' is a number");
    expect_refused("3<1", "'3' is a number");
    expect_refused("0<a b<2", "'0' is a number");
    EXPECT_EQ(selected("'a=b'=4"), "1");
    EXPECT_EQ(selected("\"a=b\">=4"), "2");
    expect_refused("a=b=4", "'b=4' is not a number");
    EXPECT_EQ(selected("a b<=6"), "2");
    EXPECT_EQ(selected("'a b'<=6"), "2");
    EXPECT_EQ(selected("'x'>=6"), "2");
    expect_refused("x>=6", "a coordinate, and an attribute");
    EXPECT_EQ(selected("'nan'=4"), "1");
    expect_refused("nan=4", "'nan' is a number");
    EXPECT_EQ(selected("'rgb[0]'=5"), "1");
    EXPECT_EQ(selected("'rgb'[0]=7"), "1");
    expect_refused("rgb[0]=5", "is an attribute of this cloud, and a component");
    EXPECT_EQ(selected("rgb[1]=7"), "1");
    EXPECT_EQ(selected("rgb[2]=7"), "1");
    EXPECT_EQ(selected("rgb[3]=8"), "1");
    EXPECT_EQ(selected("'rgb[3]'=8"), "1");
    expect_refused("rgb[4]=8", "rgb");
    expect_refused("'rgb'[3]=8", "rgb");
    expect_refused("'a b>2", "quotes");
    expect_refused("'y'>2", "no attribute 'y'");
    expect_refused("''>2", "no attribute");
}

}  // namespace
