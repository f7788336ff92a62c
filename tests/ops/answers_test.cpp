// What operations answer: the head and the keys that their rows describe, with these types, and no others.
#include "pcm/ops/operation.h"

#include "tests/clouds.h"
#include "tests/support.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <map>

namespace {

using namespace pcm::ops;
namespace fs = std::filesystem;

// How each operation of the table is called here: arguments by key. A row without a call fails the test.
using Call = std::map<std::string, std::vector<std::string>>;
using Calls = std::map<std::string, Call>;

Calls calls(const std::string& tree, const std::string& folder)
{
    return {{"radii", {{"tree", {tree}}, {"output", {folder + "/radii.pct"}}}},
            {"normals", {{"tree", {tree}}, {"output", {folder + "/normals.pct"}}, {"radii", {"on"}}}},
            {"outliers", {{"tree", {tree}}, {"output", {folder + "/clean.pct"}}}}};
}

bool has_type(const Json& value, std::string type)
{
    if (type.back() == '?') {
        if (value.is_null()) return true;
        type.pop_back();
    }
    if (type == "count") return value.is_number_integer();
    if (type == "number") return value.is_number();
    if (type == "text") return value.is_string();
    if (type == "flag") return value.is_boolean();
    if (type == "list") return value.is_array();
    return type == "object" && value.is_object();
}

class Answers : public testing::Test {
protected:
    Answers()
    {
        tree_ = (folder_ / "cloud.pct").string();
        pcm::Grid grid;
        grid.scale = {0.001, 0.001, 0.001};
        grid.offset = {512345, 4812345, 100};
        pcm::test::write_las(folder_ / "cloud.las", pcm::test::records(pcm::test::Shape::surface, 3000, 3), grid);
        pcm::build_tree({folder_ / "cloud.las"}, tree_, {});
    }
    Json answer_of(const Row& row, const Call& call)
    {
        const auto operation = row.make();
        for (const auto& [key, words] : call) {
            Argument* const argument = operation->arguments().find(key);
            if (!argument) throw std::logic_error(std::string(row.name) + " has no argument " + key);
            if (argument->kind() == ValueKind::flag)
                argument->set(words[0] == "on");
            else
                argument->set(words, key);
        }
        return json_of(row.name, operation->run({}));
    }

    pcm::test::TemporaryFolder folder_;
    std::string tree_;
};

TEST_F(Answers, HaveTheKeysOfTheirRows)
{
    const Calls all = calls(tree_, folder_.path().string());
    for (const Row& row : operations()) {
        SCOPED_TRACE(row.name);
        const auto call = all.find(row.name);
        ASSERT_NE(call, all.end()) << "this test does not call it";
        const Json answer = answer_of(row, call->second);
        std::map<std::string, std::string> types{{"command", "text"},        {"version", "text"},
                                                 {"input", "list"},          {"output", "text?"},
                                                 {"points", "count"},        {"seconds", "number"},
                                                 {"warnings", "list"},       {"notes", "list"},
                                                 {"points_in", "count"},     {"points_per_second", "number"},
                                                 {"peak_rss_bytes", "count"}};
        for (const ResultKey& key : row.results) types.emplace(key.key, key.type);
        for (const auto& [key, type] : types) {
            ASSERT_TRUE(answer.contains(key)) << key;
            EXPECT_TRUE(has_type(answer[key], type)) << key << " is " << answer[key] << ", not " << type;
        }
        for (const auto& [key, value] : answer.items()) EXPECT_TRUE(types.count(key)) << key << " is not in the row";
        EXPECT_EQ(answer["command"], row.name);
    }
}

TEST_F(Answers, ErrorsNameCodePathAndHint)
{
    const pcm::Error error(pcm::ErrorCode::not_found, "a/b.las", "there is no such file", "look elsewhere");
    const Json json = json_of_error(error)["error"];
    EXPECT_EQ(json["code"], "not_found");
    EXPECT_EQ(json["path"], "a/b.las");
    EXPECT_EQ(json["hint"], "look elsewhere");
    EXPECT_EQ(json["text"], error.what());
    EXPECT_EQ(json_of_error(ArgumentError("x"))["error"]["code"], "usage");
    EXPECT_EQ(json_of_error(std::runtime_error("x"))["error"]["code"], "failed");
    EXPECT_TRUE(json_of_error(std::runtime_error("x"))["error"]["path"].is_null());
}

}  // namespace
