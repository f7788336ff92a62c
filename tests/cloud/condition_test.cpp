// Conditions against plain C++ comparisons.
#include "pcm/cloud/condition.h"

#include "pcm/cloud/selection.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace {

using namespace pcm;

// The values that a condition on an attribute "a" selects.
template <class T>
std::vector<T> selected_of(const std::vector<T>& values, ScalarType type, const std::string& condition,
                           double scale = 1, double offset = 0)
{
    Schema schema;
    schema.add({"a", type, 1, scale, offset, ""});
    PointBatch batch;
    batch.reset(schema, false, values.size());
    std::copy(values.begin(), values.end(), batch.attributes[0].as<T>());
    Selection selection;
    selection.where.push_back(parse_condition(condition));
    Selector(selection, schema).apply(batch, nullptr);
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

TEST(Condition, InvalidTextIsRefusedWithTheReason)
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
        std::string what = "nothing was refused";
        try {
            parse_condition(text);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            what = error.what();
        }
        EXPECT_NE(what.find(reason), std::string::npos) << text << " -> " << what;
        EXPECT_NE(what.find("'" + text + "'"), std::string::npos) << what;
    }
}

}  // namespace
