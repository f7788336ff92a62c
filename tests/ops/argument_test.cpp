// Arguments: names in each face, defaults, limits, and what is written where.
#include "pcm/ops/operation.h"

#include "pcm/cloud/vector.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm::ops;

enum class Fruit { apple, pear };

TEST(Argument, NamesFollowTheKey)
{
    std::uint32_t value = 6;
    Argument argument("radius_neighbours", &value);
    argument.letter('r').help("How many").unit("points");
    EXPECT_EQ(argument.option_name(), "radius-neighbours");
    EXPECT_EQ(argument.option_names(), "-r,--radius-neighbours");
    EXPECT_EQ(argument.script_name(), "RadiusNeighbours");
    EXPECT_EQ(argument.command_help(), "How many (points; default 6)");
    EXPECT_EQ(argument.script("Radii").script_name(), "Radii");
    EXPECT_EQ(argument.positional().option_names(), "-r,--radius-neighbours,radius_neighbours");
    EXPECT_EQ(Argument("radius_neighbours", &value).positional().option_names(), "radius_neighbours");
}

TEST(Argument, AFlagThatIsOnIsSwitchedOff)
{
    bool on = true, off = false;
    Argument confidence("confidence", &on), radii("radii", &off);
    EXPECT_EQ(confidence.option_name(), "no-confidence");
    EXPECT_EQ(confidence.help("the attribute").command_help(), "Leave out: the attribute");
    EXPECT_EQ(radii.help("Also radii").command_help(), "Also radii");
    EXPECT_EQ(confidence.default_text(), "on");
    EXPECT_EQ(confidence.script_name(), "Confidence");
    EXPECT_EQ(radii.option_name(), "radii");
    confidence.set(false);
    radii.set(true);
    EXPECT_FALSE(on);
    EXPECT_TRUE(off);
    EXPECT_TRUE(confidence.is_given());
    EXPECT_EQ(confidence.option_name(), "no-confidence") << "the name does not follow the value";
}

TEST(Argument, EveryKindOfVariableGetsItsValue)
{
    double real = 0;
    std::uint32_t whole = 0;
    std::uint64_t bytes = 0;
    std::string text;
    std::vector<std::string> words;
    std::vector<double> numbers;
    std::optional<double> maybe;
    std::optional<std::uint16_t> level;
    Fruit fruit = Fruit::apple;
    Arguments arguments;
    arguments.add("real", real);
    arguments.add("whole", whole);
    arguments.add("bytes", bytes).as(ValueKind::bytes);
    arguments.add("text", text);
    arguments.add("words", words);
    arguments.add("numbers", numbers).count(3);
    arguments.add("maybe", maybe);
    arguments.add("level", level);
    arguments.choice("fruit", fruit, {{"apple", "Apple"}, {"pear", "Pear"}});
    const auto set = [&](const char* key, const std::vector<std::string>& values) {
        arguments.find(key)->set(values, key);
    };
    set("real", {"-2.5"});
    set("whole", {"1e3"});
    set("bytes", {"1.5M"});
    set("text", {"a b"});
    set("words", {"a", "b"});
    set("numbers", {"1", "-2", "3e2"});
    set("maybe", {"0.25"});
    set("level", {"7"});
    set("fruit", {"pear"});
    EXPECT_EQ(real, -2.5);
    EXPECT_EQ(whole, 1000u);
    EXPECT_EQ(bytes, 1536u << 10);
    EXPECT_EQ(text, "a b");
    EXPECT_EQ(words, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(numbers, (std::vector<double>{1, -2, 300}));
    EXPECT_EQ(maybe, 0.25);
    EXPECT_EQ(level, 7);
    EXPECT_EQ(fruit, Fruit::pear);
    EXPECT_EQ(arguments.find("bytes")->default_text(), "1536K");
    EXPECT_TRUE(arguments.given("fruit"));
    EXPECT_THROW(arguments.given("vegetable"), std::logic_error);
}

TEST(Argument, NothingGivenLeavesTheDefault)
{
    std::optional<double> maybe;
    double real = 3;
    Argument optional("maybe", &maybe), plain("real", &real);
    optional.set({}, "--maybe");
    plain.set({}, "--real");
    EXPECT_FALSE(maybe);
    EXPECT_EQ(real, 3);
    EXPECT_FALSE(plain.is_given());
    EXPECT_TRUE(optional.is_optional());
    EXPECT_FALSE(plain.is_optional());
    EXPECT_THROW(plain.required().set({}, "--real"), ArgumentError);
}

std::string fault_of(Argument& argument, const std::vector<std::string>& words)
{
    try {
        argument.set(words, "--it");
        return "";
    } catch (const ArgumentError& error) {
        return error.what();
    }
}

TEST(Argument, WhatIsNotAllowedIsNamed)
{
    std::uint32_t neighbours = 16;
    Argument whole("neighbours", &neighbours);
    whole.between(1, 1024);
    EXPECT_EQ(fault_of(whole, {"0"}), "--it: '0' is not a whole number from 1 to 1024");
    EXPECT_EQ(fault_of(whole, {"1025"}), "--it: '1025' is not a whole number from 1 to 1024");
    EXPECT_EQ(fault_of(whole, {"4", "5"}), "--it takes one value");
    EXPECT_EQ(fault_of(whole, {"1024"}), "");
    EXPECT_EQ(neighbours, 1024u);
    double size = 1;
    Argument positive("size", &size);
    positive.positive();
    for (const char* bad : {"0", "-1", "nan", "inf", "x", ""}) EXPECT_NE(fault_of(positive, {bad}), "") << bad;
    EXPECT_EQ(size, 1);
    std::vector<double> numbers;
    Argument three("at", &numbers);
    three.count(3);
    EXPECT_EQ(fault_of(three, {"1", "2"}), "--it takes 3 numbers, and got 2");
    Argument line("line", &numbers), places("points", &numbers);
    line.points(2, 2, 3);
    EXPECT_EQ(fault_of(line, {"1", "2"}), "--it takes x y of at least 2 points, not 2 numbers");
    EXPECT_EQ(fault_of(line, {"1 2 3 4 5"}), "--it takes x y of at least 2 points, not 5 numbers");
    EXPECT_EQ(fault_of(line, {"1 2 3 4 5 6 7 8"}), "--it takes x y of at most 3 points, not 8 numbers");
    EXPECT_EQ(fault_of(line, {"1 2 3 4 5 6"}), "");
    places.points(3, 1, 1000);
    EXPECT_EQ(fault_of(places, {"1 2 3 4"}), "--it takes x y z of each point, not 4 numbers");
    std::optional<std::uint16_t> level;
    Argument small("level", &level);
    EXPECT_NE(fault_of(small, {"65536"}), "");
    EXPECT_EQ(fault_of(small, {"65535"}), "");
}

TEST(Argument, DegreesAreRadiansInside)
{
    double angle = 20 * pcm::pi / 180;
    Argument argument("normal_angle", &angle);
    argument.degrees();
    EXPECT_EQ(argument.default_text(), "20");
    EXPECT_EQ(argument.unit(), "degrees");
    argument.set({"90"}, "--normal-angle");
    EXPECT_DOUBLE_EQ(angle, pcm::pi / 2);
}

TEST(Argument, NumbersMayShareAWord)
{
    std::vector<double> places;
    Argument at("at", &places);
    at.count(1, 9);
    EXPECT_EQ(fault_of(at, {"1 2 3", "4,5,6"}), "");
    EXPECT_EQ(places, (std::vector<double>{1, 2, 3, 4, 5, 6}));
    EXPECT_NE(fault_of(at, {"1 2 x"}), "");
    EXPECT_NE(fault_of(at, {"1 2 3 4 5", "6 7 8 9 10"}), "");
}

TEST(Argument, ZeroChoosesANumberAutomatically)
{
    double threshold = 0;
    Argument argument("threshold", &threshold);
    argument.positive().automatic("from the noise");
    EXPECT_TRUE(argument.is_optional());
    EXPECT_EQ(argument.default_text(), "");
    EXPECT_EQ(argument.without(), "from the noise");
    EXPECT_NE(fault_of(argument, {"0"}), "");
    EXPECT_EQ(fault_of(argument, {"0.5"}), "");
    EXPECT_EQ(threshold, 0.5);
}

TEST(Argument, WholeNumbersMayBeNegativeWhereTheirLimitIs)
{
    double value = 2;
    Argument argument("value", &value);
    argument.as(ValueKind::whole).between(-128, 127);
    EXPECT_EQ(argument.default_text(), "2");
    EXPECT_EQ(fault_of(argument, {"-3"}), "");
    EXPECT_EQ(value, -3);
    EXPECT_NE(fault_of(argument, {"1.5"}), "");
    EXPECT_NE(fault_of(argument, {"-129"}), "");
}

TEST(Argument, LabelsAreTheKeyInWordsWhereNothingElseIsSaid)
{
    double angle = 0;
    Argument argument("pixel_angle", &angle);
    EXPECT_EQ(argument.label(), "Pixel angle");
    EXPECT_EQ(argument.label("Angle").label(), "Angle");
}

// The command once showed 20 degrees and used 0.35, which is 20.05.
TEST(Argument, DetectUsesTheAngleThatItStates)
{
    const auto detect = find_operation("detect")->make();
    const Argument* const angle = detect->arguments().find("normal_angle");
    ASSERT_NE(angle, nullptr);
    EXPECT_EQ(angle->default_text(), "20");
    EXPECT_EQ(angle->unit(), "degrees");
}

TEST(Argument, FacesCanBeLeftOut)
{
    bool flag = false;
    Argument argument("device", &flag);
    EXPECT_TRUE(argument.is_in(Face::command) && argument.is_in(Face::dialog));
    argument.only(Face::command);
    EXPECT_TRUE(argument.is_in(Face::command));
    EXPECT_FALSE(argument.is_in(Face::dialog));
}

}  // namespace
