// Selectors: names of attributes, and bounds of the selected positions.
#include "pcm/cloud/selection.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace {

using namespace pcm;

Selection where(const std::vector<std::string>& conditions)
{
    Selection selection;
    for (const std::string& text : conditions) selection.where.push_back(parse_condition(text));
    return selection;
}

std::string refusal(const std::function<void()>& f)
{
    try {
        f();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "nothing was refused";
}

TEST(Selector, UnknownNamesListTheKnownOnes)
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::u8, 3, 1, 0, ""});
    for (const char* text : {"intensty=1", "rgb[x]=1", "Intensity=1"}) {
        const std::string what = refusal([&] { Selector(where({text}), schema); });
        EXPECT_NE(what.find("intensity, rgb"), std::string::npos) << what;
    }
    for (const char* text : {"rgb=1", "rgb[3]=1", "intensity[1]=1"})
        EXPECT_NE(refusal([&] { Selector(where({text}), schema); }).find("component"), std::string::npos) << text;
    Selector(where({"rgb[2]=1", "intensity[0]=1"}), schema);
    Selection selection;
    selection.keep = {"colour"};
    EXPECT_NE(refusal([&] { Selector(selection, schema); }).find("intensity, rgb"), std::string::npos);
    selection = {};
    selection.drop = {"colour"};
    EXPECT_NE(refusal([&] { Selector(selection, schema); }).find("'colour'"), std::string::npos);
}

TEST(Selector, BoundsEncloseSelectedPositions)
{
    Selection selection = where({"x=3..5,9", "y<2", "z!=1"});
    Selector selector(selection, {});
    ASSERT_TRUE(selector.bounds());
    EXPECT_EQ(selector.bounds()->min[0], 3);
    EXPECT_EQ(selector.bounds()->max[0], 9);
    EXPECT_LT(selector.bounds()->max[1], 2);
    EXPECT_EQ(selector.bounds()->max[2], std::numeric_limits<double>::infinity());
    selection.box = Box3d{{4, 0, 0}, {20, 1, 1}};
    selector = Selector(selection, {});
    EXPECT_EQ(selector.bounds()->min, (Vec3d{4, 0, 0}));
    EXPECT_EQ(selector.bounds()->max, (Vec3d{9, 1, 1}));
}

}  // namespace
