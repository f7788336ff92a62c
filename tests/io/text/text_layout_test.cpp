// Layouts that users state: what is understood, how it is described, and the texts of what is refused.
#include "pcm/io/text/text_layout.h"

#include "pcm/io/reader.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

using Names = std::vector<std::string>;

std::string refusal(const std::function<void()>& call)
{
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "";
}

TEST(TextLayout, ColumnsAreNamesBetweenBlanksAndCommas)
{
    const Names expected{"x", "y", "z", "a:f64"};
    for (const char* text : {"x y z a:f64", "x,y,z,a:f64", "  x,\ty ,, z\na:f64 ", "x, y, z, a:f64,"})
        EXPECT_EQ(parse_columns(text), expected) << text;
    EXPECT_EQ(parse_columns("- z - y x -"), (Names{"-", "z", "-", "y", "x", "-"}));
}

TEST(TextLayout, ColumnsThatMakeNoCloudAreRefused)
{
    const auto refused = [](const std::string& text) { return refusal([&] { parse_columns(text); }); };
    EXPECT_EQ(refused("x y").find("the columns 'x y' name z 0 times, not once"), 0u);
    EXPECT_NE(refused("x y").find("for example: x y z intensity r g b"), std::string::npos);
    EXPECT_EQ(refused("").find("the columns '' name x 0 times, not once"), 0u);
    EXPECT_EQ(refused("x,y,z,y").find("the columns 'x y z y' name y 2 times, not once"), 0u);
    EXPECT_EQ(refused("x y z a a").find("the columns 'x y z a a' name a more than once"), 0u);
    EXPECT_NE(refused("x y z a a").find("name a column - to skip it"), std::string::npos);
    EXPECT_EQ(refused("x y z a:u8 a:u16").find("the columns 'x y z a:u8 a:u16' name a more than once"), 0u);
    EXPECT_EQ(refused("x y z a:u7").find("the column 'a:u7' has no known type after its colon"), 0u);
    EXPECT_NE(refused("x y z :u8").find("the column ':u8' has no known type"), std::string::npos);
    EXPECT_NE(refused("x y z a:").find("types are i8 u8 i16"), std::string::npos);
}

TEST(TextLayout, ATypeMayFollowANamesLastColon)
{
    for (int t = static_cast<int>(ScalarType::i8); t <= static_cast<int>(ScalarType::f64); ++t) {
        const auto type = static_cast<ScalarType>(t);
        const NamedColumn column = named_column("a:b:" + std::string(name_of(type)));
        EXPECT_EQ(column.name, "a:b");
        EXPECT_EQ(column.type, type);
    }
    EXPECT_EQ(named_column("a").name, "a");
    EXPECT_FALSE(named_column("a").type);
}

TEST(TextLayout, IsDescribedInWords)
{
    TextLayout layout;
    EXPECT_EQ(describe(layout), "");
    layout.columns = {"x", "y", "z", "r", "g", "b"};
    EXPECT_EQ(describe(layout), "x y z r g b");
    layout.colour_range = 65535;
    layout.skip_lines = 0;
    EXPECT_EQ(describe(layout), "x y z r g b (colours 0-65535)");
    layout.skip_lines = 1;
    const char separators[] = {' ', ',', ';', '\t'};
    const Names names{"blanks", "commas", "semicolons", "tabs"};
    for (std::size_t i = 0; i < 4; ++i) {
        layout.separator = separators[i];
        EXPECT_EQ(describe(layout), "x y z r g b (colours 0-65535), separated by " + names[i] + ", 1 line skipped");
    }
    layout = {};
    layout.skip_lines = 2000;
    EXPECT_EQ(describe(layout), ", 2,000 lines skipped");
}

// By check_layout(), and by the reader that gets the layout.
TEST(TextLayout, WhatIsOutOfRangeIsRefusedBeforeReading)
{
    TemporaryFolder folder;
    const auto file = folder / "a.xyz";
    std::ofstream(file) << "1 2 3 4\n5 6 7 8\n";
    const auto refused = [&](const TextLayout& layout) {
        const std::string text = refusal([&] { check_layout(layout); });
        ReadOptions options;
        options.text = layout;
        const std::string by_reader = refusal([&] { open_reader(file, options); });
        EXPECT_EQ(text.empty(), by_reader.empty()) << by_reader;
        EXPECT_NE(by_reader.find(text), std::string::npos) << by_reader;
        return text;
    };
    TextLayout layout;
    layout.columns = {"x", "y", "z", "a"};
    for (const char separator : {' ', ';', '\t', ','}) {
        layout.separator = separator;
        EXPECT_EQ(refusal([&] { check_layout(layout); }), "");
    }
    layout.separator = ' ';
    EXPECT_EQ(refused(layout), "");
    for (const double range : {1.0, 255.0, 65535.0}) {
        layout.colour_range = range;
        EXPECT_EQ(refused(layout), "");
    }
    layout.colour_range = 256;
    EXPECT_EQ(refused(layout).find("colours up to 256 are not known"), 0u);
    EXPECT_NE(refused(layout).find("the range is 1, 255 or 65535"), std::string::npos);
    layout.colour_range.reset();
    layout.separator = '|';
    EXPECT_EQ(refused(layout).find("the separator '|' is not known"), 0u);
    EXPECT_NE(refused(layout).find("separators are a blank, a comma, a semicolon and a tab"), std::string::npos);
    layout.separator.reset();
    layout.columns = {"x", "y"};
    EXPECT_EQ(refused(layout).find("the columns 'x y' name z 0 times"), 0u);
}

}  // namespace
