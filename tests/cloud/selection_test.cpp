// Selectors: names of attributes, and bounds of the selected positions.
#include "pcm/cloud/selection.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <utility>

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

TEST(Selection, BoxesThatHoldNothingAreRefused)
{
    const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const auto& [low, high] : {std::pair{2.0, 1.0}, {nan, 1.0}, {0.0, nan}, {inf, -inf}}) {
            Box3d box{{0, 0, 0}, {1, 1, 1}};
            box.min[axis] = low;
            box.max[axis] = high;
            Selection selection;
            selection.box = box;
            const std::string along = std::string("along ") + "xyz"[axis];
            EXPECT_NE(refusal([&] { refuse_impossible_box(selection); }).find(along), std::string::npos);
            if (std::isnan(low) || std::isnan(high)) continue;
            selection = {};
            selection.region = Region::box(box);
            EXPECT_NE(refusal([&] { refuse_impossible_box(selection); }).find(along), std::string::npos);
        }
    Selection selection;
    refuse_impossible_box(selection);
    selection.box = Box3d{{-inf, 1, 2}, {inf, 1, 2}};
    selection.region = Region::box(*selection.box);
    refuse_impossible_box(selection);
    selection.region = Region::sphere({0, 0, 0}, 1);
    refuse_impossible_box(selection);
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
