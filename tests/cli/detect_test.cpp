// pcmlab detect as a user meets it, on a generated scene.

#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#include <filesystem>
#include <regex>

namespace {

using namespace pcm::test;

class DetectCommand : public CommandTest {
protected:
    void SetUp() override
    {
        ASSERT_EQ(pcmlab("generate -q -n 150000 " + path("in.las")).code, 0);
        ASSERT_EQ(pcmlab("build -q " + path("in.las")).code, 0);
    }
    void refused(const std::string& arguments, int code, const std::string& part)
    {
        const Result result = pcmlab("detect " + path("in.pct") + " " + arguments);
        EXPECT_EQ(result.code, code) << arguments << result.err;
        EXPECT_NE(result.err.find(part), std::string::npos) << arguments << ": " << result.err;
    }
};

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(DetectCommand, PCM_NOT_UNDER_ADDRESS(FindsListsAndLabels))
{
    const Result result = pcmlab("detect --json " + path("in.pct") + " --min-points 1000 --out " + path("list.json") +
                                 " --label shape -o " + path("out.pct"));
    ASSERT_EQ(result.code, 0) << result.err;
    const Json json = Json::parse(result.out);
    const Json& primitives = json["primitives"];
    ASSERT_GE(primitives.size(), 5u);
    EXPECT_EQ(json["points_in"], 150000);
    EXPECT_GT(json["threshold"], 0.004);
    std::uint64_t points = 0;
    for (const Json& primitive : primitives) {
        EXPECT_GE(primitive["points"], 1000);
        points += primitive["points"].get<std::uint64_t>();
    }
    EXPECT_EQ(json["points_changed"], points);
    const Result selected = pcmlab("select --json " + path("out.pct") + " --where shape=1");
    ASSERT_EQ(selected.code, 0) << selected.err;
    EXPECT_EQ(Json::parse(selected.out)["points"], primitives[0]["points"]);
    EXPECT_EQ(Json::parse(pcmlab("primitives --json " + path("list.json")).out)["primitives"].size(),
              primitives.size());

    // Numbers for people have the digits that are known.
    const Result text = pcmlab("detect " + path("in.pct") + " --min-points 1000");
    EXPECT_NE(text.out.find("  plane 5000"), std::string::npos) << text.out;
    EXPECT_FALSE(std::regex_search(text.out, std::regex("\\.[0-9]{9}"))) << text.out;

    // The list is there already: nothing is overwritten unasked, and nothing is searched for first.
    refused("--out " + path("list.json"), 1, "exists already");
    EXPECT_EQ(pcmlab("detect " + path("in.pct") + " --shape plane --box 500000 4800000 90 500020 4800020 110 --out " +
                     path("list.json") + " --overwrite")
                  .code,
              0);
    EXPECT_TRUE(pcmlab("select " + path("in.pct") + " --where shape=1").code != 0);  // the tree itself is as before
}

// A tree to write is one with labels, whether or not a list is written, too.
TEST_F(DetectCommand, WritesATreeAgainWithoutAList)
{
    const std::string detect =
        "detect --json " + path("in.pct") + " --shape plane --min-points 5000 -o " + path("out.pct");
    const Result first = pcmlab(detect);
    ASSERT_EQ(first.code, 0) << first.err;
    EXPECT_NE(pcmlab(detect).code, 0) << "nothing is overwritten unasked";
    const Result again = pcmlab(detect + " --overwrite");
    ASSERT_EQ(again.code, 0) << again.err;
    const Json primitives = Json::parse(again.out)["primitives"];
    ASSERT_GE(primitives.size(), 2u);
    EXPECT_NE(primitives[0]["colour"], primitives[1]["colour"]) << "shapes next to each other differ";
    const Result selected = pcmlab("select --json " + path("out.pct") + " --where primitive=1");
    ASSERT_EQ(selected.code, 0) << selected.err;
    EXPECT_EQ(Json::parse(selected.out)["points"], primitives[0]["points"]);
}

TEST_F(DetectCommand, RefusesWhatMakesNoSense)
{
    refused("--label shape", 2, "--in-place");
    refused("--overwrite", 2, "--out");
    refused("--shape cone", 2, "cone");
    refused("--threshold -1", 2, "threshold");
    refused("--min-points 3", 1, "20 are the least");
    refused("--where nothing=1", 1, "nothing");
    EXPECT_FALSE(std::filesystem::exists(path("out.pct")));
    // Before the tree is opened.
    const Result result = pcmlab("detect " + path("nowhere.pct") + " --out " + path("list.xyz"));
    EXPECT_NE(result.err.find("no format of primitives"), std::string::npos) << result.err;
}

TEST_F(DetectCommand, OfLabelsThatCannotBeWrittenThereIsNoListEither)
{
    refused("--shape sphere --out " + path("list.json") + " --label x -o " + path("in.pct"), 1, "in.pct");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "list.json"));
}

}  // namespace
