// Lists of measures and primitives that several processes add to at once.
#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#include <set>

namespace pcm::test {
namespace {

class Lists : public CommandTest {
protected:
    // Runs pcmlab with `arguments` eight times at once; $i in them is 1 to 8.
    void eight(const std::string& arguments)
    {
        const std::string command = "'" + std::string(paths::command) + "' " + arguments;
        const Result done = pcmlab(
            "help", "for i in 1 2 3 4 5 6 7 8; do { " + command + " >/dev/null || echo failed >&2; } & done; wait;");
        EXPECT_EQ(done.err, "");
    }
    std::set<std::string> names(const std::string& command, const std::string& key)
    {
        const Result shown = pcmlab(command);
        EXPECT_EQ(shown.code, 0) << shown.err;
        std::set<std::string> names;
        if (shown.code != 0) return names;
        const Json json = Json::parse(shown.out);
        for (const Json& one : json[key]) EXPECT_TRUE(names.insert(one["name"]).second) << one["name"];
        return names;
    }
};

const std::set<std::string> all_eight{"n1", "n2", "n3", "n4", "n5", "n6", "n7", "n8"};

TEST_F(Lists, MeasuresAddedAtOnceAreAllThere)
{
    const std::string list = path("measures.json");
    ASSERT_EQ(pcmlab("measure point --points 0 0 0 --name first -o " + list).code, 0);
    eight("measure point --points 1 2 3 --name n$i --list " + list + " -o " + list + " --overwrite");
    std::set<std::string> expected = all_eight;
    expected.insert("first");
    EXPECT_EQ(names("measure --json --list " + list, "measures"), expected);
}

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(Lists, PCM_NOT_UNDER_ADDRESS(PrimitivesAddedAtOnceAreAllThere))
{
    ASSERT_EQ(pcmlab("generate -q -n 20000 --no-truth --origin 0 0 0 " + path("scene.las")).code, 0);
    ASSERT_EQ(pcmlab("build -q -o " + path("t.pct") + " " + path("scene.las")).code, 0);
    const Json nearest = Json::parse(pcmlab("query --json " + path("t.pct") + " --nearest 0 0 0").out);
    std::string place;
    for (const Json& x : nearest["neighbours"][0]["position"]) place += (place.empty() ? "" : " ") + x.dump();
    const std::string list = path("list.json"), more = path("more.json");
    const std::string fit = "fit -q " + path("t.pct") + " --at '" + place + "' --shape plane --no-grow --name ";
    eight(fit + "n$i --add " + list);
    EXPECT_EQ(names("primitives --json " + list, "primitives"), all_eight);

    // Lists put behind it while others are added.
    ASSERT_EQ(pcmlab(fit + "more --add " + more).code, 0);
    eight(fit + "m$i --add " + list + "; '" + paths::command + "' primitives " + list + " --append " + more + " -o " +
          list + " --overwrite");
    const Json together = Json::parse(pcmlab("primitives --json " + list).out);
    EXPECT_EQ(together["primitives"].size(), 24u);
}

}  // namespace
}  // namespace pcm::test
