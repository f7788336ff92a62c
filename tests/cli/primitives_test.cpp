// pcmlab primitives.

#include "tests/cli/command.h"
#include "tests/faults.h"
#include "tests/paths.h"
#include "tests/sanitizers.h"

#include <fstream>

namespace {

using namespace pcm::test;

// The last line says what the answer took.
std::string without_last_line(const std::string& text) { return text.substr(0, text.rfind('\n', text.size() - 2) + 1); }

class PrimitiveCommands : public CommandTest {
protected:
    void SetUp() override
    {
        CommandTest::SetUp();
        std::ofstream(folder_ / "a.json") << R"({"format":"pcm primitives","version":1,"primitives":[
            {"name":"Pipe 1","kind":"cylinder","point":[5e5,48e5,0],"axis":[0,0,2],"radius":0.25,"inliers":1200,
             "rms":0.002,"sigma":{"radius":0.0004},"bounds":{"from":0,"to":3}},
            {"name":"Roof","kind":"cone","point":[0,0,9],"axis":[0,0,-1],"half_angle":0.5,"hidden":true,
             "sigma":{"second":null},"verdict":"doubtful","issue":"thin arc","message":"too thin"}]})";
        std::ofstream(folder_ / "b.json") << R"({"format":"pcm primitives","version":1,"primitives":[
            {"name":"Ball","kind":"sphere","point":[1,2,3],"radius":2}]})";
    }
};

TEST_F(PrimitiveCommands, ShowAList)
{
    const Result shown = pcmlab("primitives " + path("a.json") + " --unit m");
    EXPECT_EQ(shown.code, 0) << shown.err;
    EXPECT_EQ(without_last_line(shown.out),
              "Pipe 1\n"
              "  cylinder through 500000 4800000 0, axis 0 0 1\n"
              "  radius 0.2500 \u00b1 0.0004 m, length 3 m\n"
              "  1,200 inliers, rms 0.002 m\n"
              "Roof (hidden)\n"
              "  cone with its apex at 0 0 9, axis 0 0 -1\n"
              "  half angle 28.6 (not determined)\n"
              "  doubtful: too thin\n");
}

TEST_F(PrimitiveCommands, RoundToWhatIsKnownInTextAlone)
{
    std::ofstream(folder_ / "fine.json") << R"({"format":"pcm primitives","version":1,"primitives":[
        {"name":"Pipe","kind":"cylinder","point":[500000.123456789,4800000.5,0.987654321],"axis":[0.6,0,0.8],
         "radius":0.123456789,"sigma":{"position":0.002,"angle":0.001,"radius":0.0004}},
        {"name":"Elbow","kind":"torus","point":[1.23456789,2,3],"axis":[0,0,1],"radius":0.123456789,
         "tube_radius":0.0123456789,"sigma":{"position":0.01,"angle":0.1,"radius":0.02,"second":0.003}},
        {"name":"Roof","kind":"cone","point":[1.23456789,2,3],"axis":[0,0,1],"half_angle":0.5123456789,
         "sigma":{"position":0.01,"angle":0.1,"second":0.01}}]})";
    const Result shown = pcmlab("primitives " + path("fine.json"));
    EXPECT_EQ(without_last_line(shown.out),
              "Pipe\n"
              "  cylinder through 500000.1235 4800000.5000 0.9877, axis 0.6000 0 0.8000\n"
              "  radius 0.1235 \u00b1 0.0004\n"
              "Elbow\n"
              "  torus about 1.235 2.000 3.000, axis 0 0 1.00\n"
              "  radius 0.12 \u00b1 0.02, tube 0.012 \u00b1 0.003\n"
              "Roof\n"
              "  cone with its apex at 1.235 2.000 3.000, axis 0 0 1.00\n"
              "  half angle 29.4 \u00b1 0.6\u00b0\n");
    const Result exact = pcmlab("primitives --json " + path("fine.json"));
    EXPECT_EQ(Json::parse(exact.out)["primitives"][0]["point"][0], 500000.123456789);
}

TEST_F(PrimitiveCommands, WriteAndAppend)
{
    const Result done =
        pcmlab("primitives " + path("a.json") + " --append " + path("b.json") + " -o " + path("c.json") + " --to " +
               path("c.scr") + " --to " + path("c.csv") + " --unit mm --json");
    EXPECT_EQ(done.code, 0) << done.err;
    const Json json = Json::parse(done.out);
    ASSERT_EQ(json["primitives"].size(), 3u);
    EXPECT_EQ(json["primitives"][2]["name"], "Ball");
    EXPECT_EQ(json["unit"], "mm");
    EXPECT_EQ(json["files"][0]["primitives"], 3);
    EXPECT_EQ(json["files"][1]["primitives"], 2);
    EXPECT_EQ(json["notes"].size(), 2u);
    std::ifstream table(folder_ / "c.csv");
    std::string heading;
    std::getline(table, heading);
    EXPECT_NE(heading.find(",radius [mm],"), std::string::npos);
    const Result again = pcmlab("primitives " + path("c.json"));
    EXPECT_NE(again.out.find("Ball"), std::string::npos);
    const Result text = pcmlab("primitives " + path("a.json") + " --to " + path("d.scr"));
    EXPECT_NE(text.out.find("d.scr: 1 primitive\n"), std::string::npos) << text.out;
    EXPECT_EQ(text.out.rfind("note: ", 0), 0u) << text.out;
}

TEST_F(PrimitiveCommands, RefuseWithoutWriting)
{
    const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
        const Result result = pcmlab("primitives " + arguments);
        EXPECT_EQ(result.code, code) << arguments << "\n" << result.out;
        EXPECT_NE(result.err.find(words), std::string::npos) << arguments << "\n" << result.err;
    };
    refused(path("none.json"), 1, "none.json");
    refused(path("a.json") + " --to " + path("b.json"), 1, "exists already");
    refused(path("a.json") + " --to " + path("a.dwg"), 1, ".dxf, .step, .ifc, .scr");
    refused(path("a.json") + " --unit mile", 2, "mile");
    refused(path("a.json") + " --chord 0 --to " + path("a.scr"), 2, "--chord");
    refused("", 2, "list");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.scr"));
    const Result replaced = pcmlab("primitives " + path("a.json") + " --to " + path("b.json") + " --overwrite");
    EXPECT_EQ(replaced.code, 0) << replaced.err;
}

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(PrimitiveCommands, PCM_NOT_UNDER_ADDRESS(AFullOrBadDiskLeavesTheFilesAsTheyWere))
{
    namespace fs = std::filesystem;
    fs::create_directory(folder_ / "out");
    for (const std::string extension : {".dxf", ".scr", ".csv", ".json"}) {
        const fs::path file = folder_ / "out" / ("a" + extension);
        const std::vector<std::string> command{pcm::paths::command, "primitives", (folder_ / "a.json").string(), "--to",
                                               file.string(),       "--overwrite"};
        std::ofstream(file) << "mine";
        const long calls = count_calls(command, folder_ / "out");
        EXPECT_GE(calls, 3) << extension;
        for (const std::string kind : {"full", "eio", "kill"})
            for (const long at : spread(calls - 1, 10)) {
                std::ofstream(file) << "mine";
                const Faulty result = run_with_fault(command, folder_ / "out", kind, at);
                if (result.code == 0) continue;  // no later call needs space
                if (kind != "kill") EXPECT_NE(result.err.find("a" + extension), std::string::npos) << result.err;
                std::ifstream there(file);
                EXPECT_EQ(std::string(std::istreambuf_iterator<char>(there), {}), "mine") << kind << " at " << at;
                for (const auto& left : fs::directory_iterator(folder_ / "out")) {
                    if (kind != "kill") EXPECT_EQ(left.path(), file) << kind << " at " << at;
                    if (left.path() != file) fs::remove(left);
                }
            }
        fs::remove(file);
    }
}

}  // namespace
