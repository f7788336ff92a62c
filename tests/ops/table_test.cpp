// The table of operations: every row can be shown in every face, and nothing in it contradicts itself.
#include "pcm/ops/operation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>

namespace {

using namespace pcm::ops;

bool is_snake_case(const std::string& key)
{
    for (const char c : key)
        if (!(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9') && c != '_') return false;
    return !key.empty() && key.front() != '_' && key.back() != '_';
}

class EveryRow : public testing::TestWithParam<const Row*> {};

TEST_P(EveryRow, HasAUniqueNameInEachFaceForEachArgument)
{
    const auto operation = GetParam()->make();
    std::set<std::string> keys, options, scripts, labels;
    std::set<char> letters;
    for (const Argument& argument : operation->arguments().list()) {
        EXPECT_TRUE(is_snake_case(argument.key())) << argument.key();
        EXPECT_TRUE(keys.insert(argument.key()).second) << argument.key();
        EXPECT_TRUE(options.insert(argument.option_name()).second) << argument.option_name();
        if (argument.is_in(Face::dialog)) {
            EXPECT_TRUE(scripts.insert(argument.script_name()).second) << argument.script_name();
            EXPECT_TRUE(labels.insert(argument.label()).second) << argument.label();
        }
        if (argument.letter()) {
            EXPECT_TRUE(letters.insert(argument.letter()).second) << argument.letter();
        }
        for (const char* taken : {"json", "quiet", "help", "version"}) EXPECT_NE(argument.option_name(), taken);
        EXPECT_NE(argument.letter(), 'q');
        EXPECT_NE(argument.letter(), 'h');
    }
}

TEST_P(EveryRow, SaysWhatEachArgumentIs)
{
    const auto operation = GetParam()->make();
    for (const Argument& argument : operation->arguments().list()) {
        EXPECT_FALSE(argument.label().empty()) << argument.key();
        EXPECT_GE(argument.help().size(), 10u) << argument.key();
        EXPECT_NE(argument.help().back(), '.') << argument.key() << ": unit and default follow";
        EXPECT_EQ(argument.help().find("default"), std::string::npos)
            << argument.key() << ": the default comes from the variable, or from without()";
        if (argument.kind() == ValueKind::numbers) {
            EXPECT_GT(argument.count(), 0u) << argument.key();
        }
        if (argument.kind() == ValueKind::choice) {
            EXPECT_GE(argument.choices().size(), 2u) << argument.key();
        }
    }
}

// What a face shows as the default is a value that the argument takes.
TEST_P(EveryRow, TakesItsOwnDefaults)
{
    const auto operation = GetParam()->make();
    for (const Argument& argument : operation->arguments().list()) {
        const std::string given = argument.default_text();
        if (given.empty() || argument.kind() == ValueKind::flag) continue;
        std::istringstream words(argument.kind() == ValueKind::numbers ? given : "");
        std::vector<std::string> values{std::istream_iterator<std::string>(words), {}};
        if (values.empty()) values = {given};
        for (std::string& word : values) EXPECT_EQ(argument.fault(word), "") << argument.key() << " " << given;
    }
}

// Those that trade error for time take both limits, in the same units, or say why not.
TEST_P(EveryRow, TakesLimitsOfTimeAndErrorOrSaysWhyNot)
{
    const auto operation = GetParam()->make();
    const Argument* const time = operation->arguments().find("time_limit");
    const Argument* const error = operation->arguments().find("error_target");
    const std::string limits = GetParam()->limits ? GetParam()->limits : "";
    EXPECT_EQ(limits.empty(), time && error) << limits;
    if (time) {
        EXPECT_EQ(time->unit(), "s");
    }
    if (error) {
        EXPECT_TRUE(error->unit() == "source units" || error->unit() == "%") << error->unit();
    }
    EXPECT_FALSE(limits == always_exact && (time || error));
    EXPECT_EQ(usage_of(*GetParam())["limits"].is_null(), limits.empty());
    EXPECT_NE(description_of(*GetParam()).find(limits), std::string::npos);
}

TEST_P(EveryRow, HasAnAnswerThatIsDescribed)
{
    std::set<std::string> keys;
    for (const ResultKey& key : head_keys()) keys.insert(key.key);
    const std::set<std::string> types{"count", "count?", "number", "number?", "text",   "text?",
                                      "flag",  "flag?",  "list",   "list?",   "object", "object?"};
    for (const ResultKey& key : GetParam()->results) {
        EXPECT_TRUE(is_snake_case(key.key)) << key.key;
        EXPECT_TRUE(keys.insert(key.key).second) << key.key;
        EXPECT_TRUE(types.count(key.type)) << key.key << " " << key.type;
        EXPECT_NE(std::string(key.help), "") << key.key;
    }
    EXPECT_NE(std::string(GetParam()->help), "");
    EXPECT_NE(std::string(GetParam()->details), "");
}

TEST_P(EveryRow, IsToldToProgramsAsItIs)
{
    const Json usage = usage_of(*GetParam());
    EXPECT_EQ(usage["name"], GetParam()->name);
    const auto operation = GetParam()->make();
    ASSERT_EQ(usage["arguments"].size(), operation->arguments().list().size());
    for (std::size_t i = 0; i < usage["arguments"].size(); ++i) {
        const Argument& argument = operation->arguments().list()[i];
        EXPECT_EQ(usage["arguments"][i]["key"], argument.key());
        EXPECT_EQ(usage["arguments"][i]["option"], argument.option_names());
        if (argument.default_text().empty()) {
            EXPECT_TRUE(usage["arguments"][i]["default"].is_null());
        } else {
            EXPECT_EQ(usage["arguments"][i]["default"], argument.default_text());
        }
        if (argument.allowed().most) {
            EXPECT_EQ(usage["arguments"][i]["most"], *argument.allowed().most);
        }
        EXPECT_EQ(usage["arguments"][i]["positional"], argument.is_positional());
        EXPECT_EQ(usage["arguments"][i]["list"], argument.is_list());
        EXPECT_EQ(usage["arguments"][i]["on"], argument.is_switched_off());
    }
}

TEST_P(EveryRow, IsToldToAFaceWithTheArgumentsThatTheFaceShows)
{
    for (const Face face : {Face::command, Face::dialog}) {
        const auto operation = GetParam()->make();
        std::vector<Json> shown;
        for (const Argument& argument : operation->arguments().list())
            if (argument.is_in(face) && argument.is_shown()) shown.push_back(argument.key());
        const Json usage = usage_of(*GetParam(), face);
        std::vector<Json> keys;
        for (const Json& argument : usage["arguments"]) keys.push_back(argument["key"]);
        EXPECT_EQ(keys, shown);
    }
}

std::vector<const Row*> all_rows()
{
    std::vector<const Row*> rows;
    for (const Row& row : operations()) rows.push_back(&row);
    return rows;
}

// Names of tests have no hyphens.
std::string test_name(const testing::TestParamInfo<const Row*>& info)
{
    std::string name = info.param->name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Table, EveryRow, testing::ValuesIn(all_rows()), test_name);

TEST(Table, HasEachNameOnce)
{
    std::set<std::string> names, titles;
    for (const Row& row : operations()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        if (row.title) {
            EXPECT_TRUE(titles.insert(row.title).second) << row.title;
        }
        EXPECT_EQ(find_operation(row.name), &row);
    }
    EXPECT_EQ(find_operation("no such operation"), nullptr);
}

}  // namespace
