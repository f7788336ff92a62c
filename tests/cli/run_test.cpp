// A chain of operations: it gives what its commands give one after the other, leaves nothing else, and names its steps.
#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#include <set>

namespace pcm::test {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class RunTest : public CommandTest {
protected:
    RunTest() { EXPECT_EQ(pcmlab("generate -q -n 6000 --no-truth --origin 0 0 0 " + path("scan.las")).code, 0); }

    void do_commands(const std::vector<std::string>& commands)
    {
        for (const std::string& command : commands) {
            const Result result = pcmlab(command);
            ASSERT_EQ(result.code, 0) << command << "\n" << result.err;
        }
    }
    std::set<std::string> names() const
    {
        std::set<std::string> found;
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            if (entry.path().filename() != "stderr.txt") found.insert(entry.path().filename().string());
        return found;
    }
    Json answer(const std::string& arguments)
    {
        const Result result = pcmlab("run --json " + arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
};

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(RunTest, PCM_NOT_UNDER_ADDRESS(GivesTheBytesOfItsCommandsOneAfterTheOther))
{
    do_commands({"build -q " + path("scan.las") + " -o " + path("a.pct"),
                 "outliers -q " + path("a.pct") + " -k 16 -a 3 -o " + path("b.pct"),
                 "subsample -q " + path("b.pct") + " -s 0.4 -o " + path("c.pct"),
                 "normals -q " + path("c.pct") + " -k 12 -o " + path("d.pct"),
                 "convert -q " + path("d.pct") + " " + path("by-hand.las"),
                 "run " + path("scan.las") + " --outliers 16,3 --subsample 0.4 --normals 12 -o " + path("chain.las")});
    EXPECT_EQ(bytes_of(folder_ / "chain.las"), bytes_of(folder_ / "by-hand.las"));
    // The last step writes the file itself.
    do_commands(
        {"subsample -q " + path("b.pct") + " -s 0.4 -o " + path("by-hand.xyz"),
         "run " + path("scan.las") + " --outliers neighbours=16,factor=3 --subsample 0.4 -o " + path("chain.xyz")});
    EXPECT_EQ(bytes_of(folder_ / "chain.xyz"), bytes_of(folder_ / "by-hand.xyz"));
    EXPECT_EQ(names(), (std::set<std::string>{"scan.las", "a.pct", "b.pct", "c.pct", "d.pct", "by-hand.las",
                                              "chain.las", "by-hand.xyz", "chain.xyz"}));
}

TEST_F(RunTest, KeepsTheOrderAndRepetitionOfSteps)
{
    const Json json = answer(path("scan.las") + " --transform 0,0,1 --set classification=7 --transform 0,0,2 " +
                             "--set classification=9,where=z=..1 --delete classification=7 -o " + path("out.pct"));
    std::vector<std::string> steps;
    for (const Json& step : json["steps"]) steps.push_back(step["operation"]);
    EXPECT_EQ(steps, (std::vector<std::string>{"transform", "set", "transform", "set", "delete"}));
    const std::uint64_t left = json["points"];
    EXPECT_GT(left, 0u);
    EXPECT_LT(left, 6000u);
    EXPECT_EQ(json["points_in"], 6000);
    EXPECT_EQ(json["steps"][3]["points_set"], left);
    EXPECT_EQ(json["steps"][4]["points_deleted"], 6000 - left);
    const Json moved = Json::parse(pcmlab("info --json " + path("out.pct")).out);
    EXPECT_EQ(moved["points"], left);
    const Json first = Json::parse(pcmlab("info --json --scan " + path("scan.las")).out);
    EXPECT_NEAR(moved["bounds"]["min"][2].get<double>(), first["scanned"]["bounds"]["min"][2].get<double>() + 3, 1e-6);
    EXPECT_EQ(pcmlab("verify " + path("out.pct")).code, 0);
}

TEST_F(RunTest, LeavesAnInputTreeAsItIs)
{
    do_commands({"build -q " + path("scan.las") + " -o " + path("a.pct")});
    const std::string before = pcmlab("info --json " + path("a.pct")).out;
    for (const std::string step : {"--set classification=7", "--outliers 8 --delete z=..0", "--normals 8"}) {
        SCOPED_TRACE(step);
        const Json json = answer(path("a.pct") + " " + step + " --overwrite -o " + path("out.pct"));
        EXPECT_EQ(json["points_in"], 6000);
        EXPECT_EQ(pcmlab("verify " + path("out.pct")).code, 0);
    }
    answer(path("a.pct") + " --set classification=7 -o " + path("out.las"));
    const Json changed = Json::parse(pcmlab("info --json --statistics " + path("out.pct")).out);
    EXPECT_EQ(changed["points"], 6000);
    const auto without_memory = [](const std::string& text) {
        Json json = Json::parse(text);
        for (const char* const key : {"seconds", "cpu_seconds", "peak_memory", "bytes_read"}) json.erase(key);
        return json;
    };
    EXPECT_EQ(without_memory(pcmlab("info --json " + path("a.pct")).out), without_memory(before));
    EXPECT_EQ(names(), (std::set<std::string>{"scan.las", "a.pct", "out.pct", "out.las"}));
}

TEST_F(RunTest, TakesFoldersAndAPartOfTheirPoints)
{
    fs::create_directories(folder_ / "scans/more");
    fs::copy(folder_ / "scan.las", folder_ / "scans/one.las");
    fs::copy(folder_ / "scan.las", folder_ / "scans/more/two.las");
    EXPECT_EQ(answer(path("scans") + " --set classification=1 -o " + path("all.pct"))["points"], 12000);
    const Json part = answer(path("scans") + " --where 'z>=0' --set classification=1 -o " + path("part.las"));
    EXPECT_EQ(part["points"], part["points_in"]);
    EXPECT_LT(part["points"], 12000);
    EXPECT_GT(part["points"], 0);
    EXPECT_EQ(part["output"], (folder_ / "part.las").string());
    const Result none = pcmlab("run " + path("scan.las") + " --where 'z>=1e6' --normals 8 -o " + path("none.pct"));
    EXPECT_EQ(none.code, 1);
    EXPECT_EQ(names(), (std::set<std::string>{"scan.las", "scans", "all.pct", "part.las"}));
}

TEST_F(RunTest, NamesTheStepThatFailsAndLeavesNothing)
{
    const std::pair<std::string, std::string> usage[] = {
        {"--outliers 16,x", "step 1, outliers 16,x: factor: 'x' is not a number"},
        {"--normals 8 --outliers 16,3,4", "step 2, outliers 16,3,4: '4' is one value too many"},
        {"--outliers count", "step 1, outliers count: this only counts"},
        {"--radii 8,device=gpu",
         "step 1, radii 8,device=gpu: device=gpu: a chain, and what is made of files, is computed on the processor"},
        {"--normals 8,viewpoint=0,0,9,direction=0,0,1", "step 1, normals 8,viewpoint=0,0,9,direction=0,0,1: "},
        {"", "no step is given: "},
        {"--nomrals 8", "there is no option --nomrals; perhaps --normals"}};
    for (const auto& [steps, message] : usage) {
        SCOPED_TRACE(steps);
        const Result result = pcmlab("run " + path("scan.las") + " " + steps + " -o " + path("out.pct"));
        EXPECT_EQ(result.code, 2);
        EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
    }
    const Result failed =
        pcmlab("run --json " + path("scan.las") + " --set classification=3 --delete nothing=3 -o " + path("out.las"));
    EXPECT_EQ(failed.code, 1);
    EXPECT_NE(failed.err.find("step 2, delete nothing=3: this cloud has no attribute 'nothing'"), std::string::npos)
        << failed.err;
    EXPECT_EQ(failed.err.find(".part"), std::string::npos) << "a path that is gone: " << failed.err;
    EXPECT_EQ(Json::parse(failed.out)["error"]["code"], "invalid_argument");
    EXPECT_EQ(pcmlab("run " + path("scan.las") + " --normals 8 -o " + path("scan.las") + " --overwrite").code, 1);
    EXPECT_EQ(names(), std::set<std::string>{"scan.las"});
}

TEST_F(RunTest, NotesLevelsWithGapsWhereTheOutputHasThem)
{
    do_commands({"build -q " + path("scan.las") + " -o " + path("a.pct")});
    const auto notes_levels = [&](const std::string& arguments) {
        return answer(path("a.pct") + " --delete z=..-1 " + arguments + " --overwrite")["notes"].dump().find("gaps") !=
               std::string::npos;
    };
    EXPECT_TRUE(notes_levels("-o " + path("out.pct")));
    EXPECT_TRUE(notes_levels("--normals 8 -o " + path("out.pct")));
    EXPECT_FALSE(notes_levels("--subsample 0.5 -o " + path("out.pct"))) << "its levels are new";
    EXPECT_FALSE(notes_levels("-o " + path("out.las"))) << "a file has none";
}

}  // namespace
}  // namespace pcm::test
