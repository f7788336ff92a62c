// Conditions, boxes and lists of attributes against the plain meaning of their words.

#include "pcm/cloud/selection.h"

#include "pcm/system/error.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <cmath>
#include <limits>

namespace {

using namespace pcm;
using namespace pcm::test;

const Grid grid{{0.01, 0.01, 0.01}, {1000, 2000, 0}};

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

// Which of `values` a condition on an attribute "a" selects.
template <class T>
std::vector<T> selected_of(const std::vector<T>& values, ScalarType type, const std::string& condition,
                           double scale = 1, double offset = 0)
{
    Schema schema;
    schema.add({"a", type, 1, scale, offset, ""});
    PointBatch batch;
    batch.reset(schema, false, values.size());
    std::copy(values.begin(), values.end(), batch.attributes[0].as<T>());
    Selector(where({condition}), schema).apply(batch, nullptr);
    return std::vector<T>(batch.attributes[0].as<T>(), batch.attributes[0].as<T>() + batch.size);
}

TEST(Condition, ListsRangesAndRelations)
{
    std::vector<std::uint8_t> all(256);
    for (unsigned i = 0; i < 256; ++i) all[i] = static_cast<std::uint8_t>(i);
    const auto expect = [&](const std::string& condition, const std::function<bool(int)>& meaning) {
        std::vector<std::uint8_t> expected;
        for (int i = 0; i < 256; ++i)
            if (meaning(i)) expected.push_back(static_cast<std::uint8_t>(i));
        EXPECT_EQ(selected_of(all, ScalarType::u8, condition), expected) << condition;
    };
    expect("a=2,6", [](int v) { return v == 2 || v == 6; });
    expect(" a == 2 , 6 ", [](int v) { return v == 2 || v == 6; });
    expect("a!=2,6", [](int v) { return v != 2 && v != 6; });
    expect("a=3..5,9", [](int v) { return (v >= 3 && v <= 5) || v == 9; });
    expect("a!=3..5", [](int v) { return v < 3 || v > 5; });
    expect("a=..5,250..", [](int v) { return v <= 5 || v >= 250; });
    expect("a<5", [](int v) { return v < 5; });
    expect("a<=5", [](int v) { return v <= 5; });
    expect("a>250.5", [](int v) { return v > 250; });
    expect("a>=250.5", [](int v) { return v > 250; });
    expect("a<250.5", [](int v) { return v <= 250; });
    expect("a=2.5", [](int) { return false; });
    expect("a!=2.5", [](int) { return true; });
    expect("a=-1", [](int) { return false; });
    expect("a<1000", [](int) { return true; });
    expect("a>1e300", [](int) { return false; });
    expect("a>=-1e300", [](int) { return true; });
    expect("a=+7", [](int v) { return v == 7; });
}

TEST(Condition, SixtyFourBitsAreExact)
{
    const std::vector<std::uint64_t> big = {std::numeric_limits<std::uint64_t>::max() - 1,
                                            std::numeric_limits<std::uint64_t>::max(), (std::uint64_t(1) << 53),
                                            (std::uint64_t(1) << 53) + 1};
    using U = std::vector<std::uint64_t>;
    EXPECT_EQ(selected_of(big, ScalarType::u64, "a=18446744073709551615"), U{big[1]});
    EXPECT_EQ(selected_of(big, ScalarType::u64, "a<18446744073709551615"), (U{big[0], big[2], big[3]}));
    EXPECT_EQ(selected_of(big, ScalarType::u64, "a=9007199254740993"), U{big[3]});
    const std::vector<std::int64_t> low = {std::numeric_limits<std::int64_t>::min(),
                                           std::numeric_limits<std::int64_t>::min() + 1, -1};
    using I = std::vector<std::int64_t>;
    EXPECT_EQ(selected_of(low, ScalarType::i64, "a=-9223372036854775808"), I{low[0]});
    EXPECT_EQ(selected_of(low, ScalarType::i64, "a>-9223372036854775808"), (I{low[1], low[2]}));
}

TEST(Condition, ValuesAreThoseThatUsersSee)
{
    std::vector<std::int16_t> raw;
    for (int i = -300; i <= 300; ++i) raw.push_back(static_cast<std::int16_t>(i));
    using V = std::vector<std::int16_t>;
    // Scan angles of LAS 1.4: 100 * 0.006 is not the double 0.6.
    EXPECT_EQ(selected_of(raw, ScalarType::i16, "a=0.6", 0.006), V{100});
    EXPECT_EQ(selected_of(raw, ScalarType::i16, "a>=1.788", 0.006), (V{298, 299, 300}));
    EXPECT_EQ(selected_of(raw, ScalarType::i16, "a>1.788", 0.006), (V{299, 300}));
    EXPECT_EQ(selected_of(raw, ScalarType::i16, "a=0.603", 0.006), V{});
    EXPECT_EQ(selected_of(raw, ScalarType::i16, "a=12..14", 2, 10), (V{1, 2}));
    EXPECT_EQ(selected_of(raw, ScalarType::i16, "a>598", -2), (V{-300}));
    EXPECT_EQ(selected_of(raw, ScalarType::i16, "a<=-598", -2), (V{299, 300}));
    const std::vector<float> floats = {0.1f, std::nextafter(0.1f, 1.0f), NAN, INFINITY, -INFINITY, 0};
    EXPECT_EQ(selected_of(floats, ScalarType::f32, "a=0.1"), std::vector<float>{0.1f});
    EXPECT_EQ(selected_of(floats, ScalarType::f32, "a>0.1").size(), 2u);
    EXPECT_EQ(selected_of(floats, ScalarType::f32, "a<=0.1").size(), 3u);
    EXPECT_EQ(selected_of(floats, ScalarType::f32, "a!=0.1").size(), 5u);
    EXPECT_EQ(selected_of(floats, ScalarType::f32, "a<=1e300"), (std::vector<float>{0.1f, floats[1], -INFINITY, 0}));
}

TEST(Condition, WhatMakesNoSenseIsRefusedWithTheReason)
{
    const std::vector<std::pair<std::string, std::string>> bad = {{"classification", "no ="},
                                                                  {"=3", "before the sign"},
                                                                  {"a!3", "followed by '='"},
                                                                  {"a=", "number is missing"},
                                                                  {"a=1,", "number is missing"},
                                                                  {"a=x", "'x' is not a number"},
                                                                  {"a=1..x", "'x'"},
                                                                  {"a=..", "at least one end"},
                                                                  {"a=5..3", "ends before"},
                                                                  {"a<1,2", "one number"},
                                                                  {"a>=1..2", "one number"},
                                                                  {"a=nan", "finite"},
                                                                  {"a=1e999", "too large"},
                                                                  {"a=1 2", "'1 2'"},
                                                                  {"", "no ="},
                                                                  {"a=0x10", "'0x10'"}};
    for (const auto& [text, reason] : bad) {
        const std::string what = refusal([&, t = text] { parse_condition(t); });
        EXPECT_NE(what.find(reason), std::string::npos) << text << " -> " << what;
        EXPECT_NE(what.find("'" + text + "'"), std::string::npos) << what;
    }
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

Schema mixed_schema()
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::u8, 3, 1, 0, ""});
    schema.add({"time", ScalarType::f64, 1, 1, 0, ""});
    schema.add({"odd", ScalarType::i32, 5, 1, 0, ""});
    return schema;
}

class EveryForm : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(SelectedReader, EveryForm, testing::Bool());

// A random selection of a random cloud against a loop over its points.
TEST_P(EveryForm, SelectsWhatALoopSelects)
{
    std::mt19937_64 random(4);
    for (int round = 0; round < 40; ++round) {
        const MemoryCloud cloud =
            random_cloud(mixed_schema(), GetParam() ? std::optional<Grid>(grid) : std::nullopt, 3000, random(), 100);
        Selection selection = where({"intensity>=20000", "rgb[1]!=0..50,255", "time<5e5"});
        selection.where.resize(random() % 4);
        if (random() % 2) {
            selection.box.emplace();
            selection.box->extend(
                position_of(cloud.points, cloud.info.grid, random() % 3000));  // closed: its corners are points
            selection.box->extend(position_of(cloud.points, cloud.info.grid, random() % 3000));
        }
        const double x = position_of(cloud.points, cloud.info.grid, 7)[0];
        if (random() % 2) selection.where.push_back(parse_condition("x<=" + std::to_string(x)));
        if (round % 3 == 1) selection.keep = {"odd", "intensity"};
        if (round % 3 == 2) selection.drop = {"rgb"};

        const auto column = [&](std::size_t k) -> const Column& { return cloud.points.attributes[k]; };
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < cloud.points.size; ++i) {
            const Vec3d p = position_of(cloud.points, cloud.info.grid, i);
            bool wanted = !selection.box || selection.box->contains(p);
            for (const Condition& condition : selection.where) {
                if (condition.name == "intensity") wanted = wanted && column(0).value(i) >= 20000;
                if (condition.name == "rgb[1]")
                    wanted = wanted && column(1).value(i, 1) > 50 && column(1).value(i, 1) != 255;
                if (condition.name == "time") wanted = wanted && column(2).value(i) < 5e5;
                if (condition.name == "x") wanted = wanted && p[0] <= std::stod(std::to_string(x));
            }
            if (wanted) expected.push_back(i);
        }
        SelectedReader reader(std::make_unique<MemoryReader>(cloud), selection);
        EXPECT_EQ(reader.info().points_known, !selection.chooses_points());
        EXPECT_EQ(reader.seekable(), !selection.chooses_points());
        const MemoryCloud result = read_all(reader, 1 + random() % 500);
        EXPECT_EQ(reader.points_seen(), cloud.points.size);
        std::vector<std::string> names;
        for (const Attribute& attribute : result.info.schema) names.push_back(attribute.name);
        EXPECT_EQ(names, round % 3 == 1   ? (std::vector<std::string>{"intensity", "odd"})
                         : round % 3 == 2 ? (std::vector<std::string>{"intensity", "time", "odd"})
                                          : (std::vector<std::string>{"intensity", "rgb", "time", "odd"}));
        ASSERT_EQ(result.points.size, expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            ASSERT_EQ(position_of(result.points, result.info.grid, i),
                      position_of(cloud.points, cloud.info.grid, expected[i]));
            for (std::size_t k = 0; k < names.size(); ++k)
                ASSERT_EQ(bytes_of(result.points.attributes[k], i),
                          bytes_of(column(*cloud.info.schema.find(names[k])), expected[i]));
        }
    }
}

TEST(SelectedReader, AnAttributeCalledXComesBeforeTheCoordinate)
{
    Schema schema;
    schema.add({"x", ScalarType::u8, 1, 1, 0, ""});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 10, 1);
    cloud.points.attributes[0].as<std::uint8_t>()[3] = 77;
    for (std::size_t i = 0; i < 10; ++i)
        if (i != 3) cloud.points.attributes[0].as<std::uint8_t>()[i] = 0;
    SelectedReader reader(std::make_unique<MemoryReader>(cloud), where({"x=77"}));
    EXPECT_EQ(read_all(reader).points.size, 1u);
}

TEST(SelectedReader, BoundsSayWhereSelectedPointsCanBe)
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
