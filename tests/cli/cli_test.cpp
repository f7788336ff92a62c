// The pcmlab command as a user meets it: output, JSON, exit codes.

#include "pcm/cloud/region.h"
#include "tests/cli/command.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class CliTest : public CommandTest {};

std::string whole_file(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(CliTest, BuildComputesNormalsInTheSameCommand)
{
    ASSERT_EQ(pcmlab("generate -q -n 30000 --no-truth " + path("scene.las")).code, 0);
    const Result both = pcmlab("build -q --json --normals 12 -o " + path("both.pct") + " " + path("scene.las"));
    ASSERT_EQ(both.code, 0) << both.err;
    const Json report = Json::parse(both.out);
    EXPECT_EQ(report["points"], 30000);
    EXPECT_EQ(report["normals"]["points"], 30000);
    EXPECT_GT(report["normals"]["seconds"], 0);
    ASSERT_EQ(pcmlab("build -q -o " + path("plain.pct") + " " + path("scene.las")).code, 0);
    ASSERT_EQ(pcmlab("normals -q -k 12 --radii -o " + path("after.pct") + " " + path("plain.pct")).code, 0);
    for (const std::string name : {"both", "after"})
        ASSERT_EQ(pcmlab("convert -q " + path(name + ".pct") + " " + path(name + ".ply")).code, 0);
    const std::string points = whole_file(folder_ / "both.ply");
    EXPECT_NE(points.find("property float nx"), std::string::npos);
    EXPECT_NE(points.find("radius"), std::string::npos);
    EXPECT_TRUE(points == whole_file(folder_ / "after.ply"));

    const Result few = pcmlab("build -q --normals 0 -o " + path("none.pct") + " " + path("scene.las"));
    EXPECT_EQ(few.code, 2) << few.err;
    EXPECT_NE(few.err.find("1 to 1024"), std::string::npos) << few.err;
}

TEST_F(CliTest, GenerateBuildInfoVerify)
{
    const Result generated =
        pcmlab("generate -n 250000 --seed 7 --origin 5000000,4800000,100 --json " + path("scene.las"));
    ASSERT_EQ(generated.code, 0) << generated.err;
    EXPECT_EQ(Json::parse(generated.out)["points"], 250000);
    EXPECT_TRUE(fs::exists(folder_ / "scene.truth.json"));

    const Result built = pcmlab("build --json --memory 128M " + path("scene.las"));
    ASSERT_EQ(built.code, 0) << built.err;
    const Json build = Json::parse(built.out);
    EXPECT_EQ(build["points"], 250000);
    EXPECT_EQ(build["position_error"], 0);
    for (const char* key : {"seconds", "peak_memory", "bytes"}) EXPECT_GT(build[key], 0) << key;
    EXPECT_TRUE(fs::exists(folder_ / "scene.pct" / "index.pct"));

    const Result asked = pcmlab("info --json " + path("scene.pct"));
    ASSERT_EQ(asked.code, 0) << asked.err;
    const Json info = Json::parse(asked.out);
    EXPECT_EQ(info["points"], 250000);
    EXPECT_EQ(info["scale"], Json({0.001, 0.001, 0.001}));
    EXPECT_GE(info["bounds"]["min"][0], 4999990.0);
    EXPECT_GT(info["levels"], 1);
    EXPECT_EQ(info["level"].size(), info["levels"]);
    EXPECT_EQ(info["level"].back()["points_to_here"], 250000);
    EXPECT_GT(info["level"][0]["spacing"], 0);
    EXPECT_EQ(info["bytes"], build["bytes"]);
    bool colour = false;
    for (const Json& attribute : info["attributes"])
        colour = colour || (attribute["name"] == "rgb" && attribute["type"] == "u16" && attribute["components"] == 3);
    EXPECT_TRUE(colour);

    const Result verified = pcmlab("verify --json " + path("scene.pct"));
    ASSERT_EQ(verified.code, 0) << verified.err;
    EXPECT_EQ(Json::parse(verified.out)["points"], 250000);
    EXPECT_TRUE(Json::parse(verified.out)["faults"].empty());

    // The same as text.
    for (const char* command : {"info ", "verify "}) {
        const Result text = pcmlab(command + path("scene.pct"));
        EXPECT_EQ(text.code, 0);
        EXPECT_NE(text.out.find("250,000"), std::string::npos) << text.out;
    }
    // A tree is overwritten only with --overwrite.
    const Result again = pcmlab("build " + path("scene.las"));
    EXPECT_EQ(again.code, 1);
    EXPECT_NE(again.err.find("scene.pct"), std::string::npos);
    EXPECT_EQ(info["sampling"], "poisson");
    EXPECT_EQ(pcmlab("build --overwrite --fast " + path("scene.las")).code, 0);
    EXPECT_EQ(Json::parse(pcmlab("info --json " + path("scene.pct")).out)["sampling"], "grid");
    EXPECT_NE(pcmlab("info " + path("scene.pct")).out.find("on a grid"), std::string::npos);
    EXPECT_EQ(pcmlab("verify " + path("scene.pct")).code, 0);
}

TEST_F(CliTest, TheHelpListsTheCommandsAndEachHasItsOwn)
{
    const Result help = pcmlab("--help");
    EXPECT_EQ(help.code, 0);
    std::istringstream lines(help.out.substr(help.out.find("Subcommands:")));
    std::string line, name, word;
    std::getline(lines, line);
    std::set<std::string> names;
    while (std::getline(lines, line) && std::istringstream(line) >> name >> word) {
        EXPECT_TRUE(names.insert(name).second) << name << " is listed twice";
        const Result own = pcmlab(name + " --help");
        EXPECT_EQ(own.code, 0) << name;
        EXPECT_NE(own.out.find("Usage: pcmlab " + name), std::string::npos) << own.out;
        EXPECT_LE(std::count(own.out.begin(), own.out.end(), '\n'), 50) << own.out;  // a screen
    }
    for (const char* expected : {"build", "convert", "info", "verify", "append", "compact", "delete", "repair", "query",
                                 "set", "transform", "align", "render", "generate"})
        EXPECT_EQ(names.count(expected), 1u) << expected << " is missing in\n" << help.out;
}

// For programs, man(1) and shells, made from the same rows.
TEST_F(CliTest, UsageForProgramsHasTheArgumentsOfEveryCommand)
{
    const Json all = Json::parse(pcmlab("help --json").out)["commands"];
    const std::string completion = pcmlab("help --completion bash").out;
    ASSERT_GT(all.size(), 20u);
    for (const Json& command : all) {
        const std::string name = command["name"];
        EXPECT_EQ(Json::parse(pcmlab("help --json " + name).out), command);
        EXPECT_FALSE(command["arguments"].empty()) << name;
        EXPECT_NE(pcmlab("help --man " + name).out.find(".SH OPTIONS\n.TP"), std::string::npos) << name;
        EXPECT_NE(completion.find(name + ") words='--help --json --quiet --"), std::string::npos) << name;
    }
    const Json render = Json::parse(pcmlab("help --json render").out);
    std::map<std::string, Json> arguments;
    for (const Json& argument : render["arguments"]) arguments[argument["key"]] = argument;
    EXPECT_EQ(arguments["splats"]["default"], "fitted");
    EXPECT_GE(arguments["splats"]["choices"].size(), 5u);
    EXPECT_EQ(arguments["gamma"]["least"], 0.1);
    EXPECT_EQ(arguments["colour"]["option"], "--colour,--color");
    EXPECT_EQ(arguments["l1"]["default"], "512M");
    EXPECT_NE(completion.find("--eye-dome"), std::string::npos);
    EXPECT_EQ(pcmlab("help --json nothing").code, 2);
    EXPECT_EQ(pcmlab("help --completion fish").code, 2);
}

TEST_F(CliTest, ConvertTakesARegionOfFilesAndTreesAlike)
{
    const auto points = records(Shape::volume, 5000, 1);
    write_las(folder_ / "in.las", points, {{0.01, 0.01, 0.01}, {0, 0, 0}});
    ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
    for (const std::string region :
         {"--sphere 10 20 -30 300", "--region 'sphere 10,20,-30 300'", "--oriented-box 0 0 0 300 100 400 30",
          "--cone -500 0 0 1 0 0 20", "--ray -600 -600 -600 1 1 1 150 900", "--frustum 0 -900 0 0 0 0 40 1.5 10 1000",
          "--planes 0 0 0 1 1 0 5 -1 0 1 7", "--polygon -500 -500 500 -500 500 500 0 0 -500 500",
          "--region 'prism 10 20 30 0 1 0 0 0 1 -300 -300 300 -300 0 400'"}) {
        std::size_t expected = 0;
        const std::size_t quote = region.find('\'');
        const std::string words =
            quote == std::string::npos ? region.substr(2) : region.substr(quote + 1, region.size() - quote - 2);
        const ::pcm::Region chosen = ::pcm::parse_region(words);
        for (const LasRecord& p : points) expected += chosen.contains({p.x * 0.01, p.y * 0.01, p.z * 0.01});
        EXPECT_GT(expected, 20u) << region;
        for (const char* input : {"in.las", "in.pct"}) {
            const Result result =
                pcmlab("convert --json --overwrite " + path(input) + " " + path("part.ply") + " " + region);
            ASSERT_EQ(result.code, 0) << result.err;
            EXPECT_EQ(Json::parse(result.out)["points"], expected) << region << " of " << input;
        }
    }
    const Result two =
        pcmlab("convert " + path("in.las") + " " + path("b.ply") + " --sphere 0 0 0 1 --region 'sphere 0 0 0 1'");
    EXPECT_EQ(two.code, 1);
    EXPECT_NE(two.err.find("one region"), std::string::npos) << two.err;
    const Result bad = pcmlab("convert " + path("in.las") + " " + path("b.ply") + " --sphere 0 0 0 -1");
    EXPECT_EQ(bad.code, 1);
    EXPECT_NE(bad.err.find("radius is -1"), std::string::npos) << bad.err;
    EXPECT_FALSE(fs::exists(folder_ / "b.ply"));
}

TEST_F(CliTest, ConvertTakesAPartAndReportsIt)
{
    write_las(folder_ / "in.las", records(Shape::volume, 5000, 1), {{0.01, 0.01, 0.01}, {0, 0, 0}});
    const Result made = pcmlab("convert --json --chunk-points 1000 " + path("in.las") + " " + path("in.pct"));
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_EQ(Json::parse(made.out)["points"], 5000);

    std::size_t in_box = 0;
    for (const LasRecord& p : records(Shape::volume, 5000, 1))
        in_box += p.x >= -20000 && p.x <= 20000 && p.y >= -30000 && p.y <= 0 && p.intensity >= 1000;
    const Result part = pcmlab("convert --json " + path("in.pct") + " " + path("part.ply") +
                               " --box -200 -300 -1e9 200 0 1e9 --where 'intensity>=1000' --attributes intensity,rgb");
    ASSERT_EQ(part.code, 0) << part.err;
    const Json json = Json::parse(part.out);
    EXPECT_EQ(json["points"], in_box);
    EXPECT_EQ(json["position_error"], 0);
    EXPECT_EQ(json["bytes"], fs::file_size(folder_ / "part.ply"));
    for (const char* key : {"seconds", "peak_memory"}) EXPECT_GT(json[key], 0) << key;

    const Result asked = pcmlab("info --json --scan " + path("part.ply"));
    ASSERT_EQ(asked.code, 0) << asked.err;
    const Json info = Json::parse(asked.out);
    EXPECT_EQ(info["points"], in_box);
    EXPECT_EQ(info["scanned"]["points"], in_box);
    EXPECT_GE(info["scanned"]["bounds"]["min"][0], -200);
    EXPECT_LE(info["scanned"]["bounds"]["max"][1], 0);
    ASSERT_EQ(info["attributes"].size(), 2u);
    EXPECT_EQ(info["attributes"][0]["name"], "intensity");

    const Result text =
        pcmlab("convert --overwrite --where classification=1,2 " + path("in.pct") + " " + path("part.ply"));
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_NE(text.out.find("part.ply: "), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("error 0 (exact)"), std::string::npos) << text.out;
}

TEST_F(CliTest, TheOutputOfConvertIsTheLastPathOrAnOption)
{
    write_las(folder_ / "in.las", records(Shape::surface, 100, 1), {});
    write_las(folder_ / "on.las", records(Shape::surface, 50, 2), {});
    const std::string both = path("in.las") + " " + path("on.las");
    for (const std::string& words : {both + " " + path("last.ply"), both + " -o " + path("option.ply"),
                                     "--output " + path("first.ply") + " " + both}) {
        const Result made = pcmlab("convert --json " + words);
        ASSERT_EQ(made.code, 0) << made.err;
        const Json json = Json::parse(made.out);
        EXPECT_EQ(json["points"], 150);
        EXPECT_EQ(json["input"], (Json{(folder_ / "in.las").string(), (folder_ / "on.las").string()}));
        EXPECT_TRUE(fs::exists(json["output"].get<std::string>()));
    }
    EXPECT_TRUE(fs::exists(folder_ / "option.ply"));
    const Result none = pcmlab("convert " + path("in.las"));
    EXPECT_EQ(none.code, 2);
    EXPECT_NE(none.err.find("an input and an output are needed"), std::string::npos) << none.err;
}

TEST_F(CliTest, ConvertRefusesWithTheReason)
{
    write_las(folder_ / "in.las", records(Shape::surface, 100, 1), {});
    const auto refused = [&](const std::string& arguments, int code, const std::string& reason) {
        const Result result = pcmlab("convert " + arguments);
        EXPECT_EQ(result.code, code) << arguments;
        EXPECT_NE(result.err.find(reason), std::string::npos) << arguments << ": " << result.err;
    };
    const std::string in = path("in.las") + " ";
    refused(in, 2, "an input and an output");
    refused(in + path("in.las"), 1, "this is the input");
    refused(in + path("out.stl"), 1, "writable are");
    refused(in + path("out.ply") + " --where intensty=3", 1, "intensity");
    refused(in + path("out.ply") + " --where intensity", 1, "no =");
    refused(in + path("out.ply") + " --box 1 2 3", 2, "--box");
    refused(in + path("out.ply") + " --box 1 2 3 0 5 6", 1, "along x");
    refused(in + path("out.ply") + " --level 2", 1, "only point cloud trees have levels");
    refused(in + path("out.ply") + " --grid 0.01", 1, "grid");
    refused(in + path("out.ply") + " --separator xx", 1, "'xx'");
    refused(path("no.las") + " " + path("out.ply"), 1, "no.las");
    EXPECT_FALSE(fs::exists(folder_ / "out.ply"));
}

TEST_F(CliTest, InfoOfFiles)
{
    fs::create_directory(folder_ / "tiles");
    write_las(folder_ / "tiles" / "a.las", records(Shape::surface, 100, 1), {});
    write_las(folder_ / "tiles" / "b.las", records(Shape::surface, 50, 1), {});
    const Result one = pcmlab("info " + path("tiles/a.las"));
    ASSERT_EQ(one.code, 0) << one.err;
    for (const char* word : {"LAS 1.2, point format 2", "100", "intensity:u16", "rgb:u16x3", "i32 on a grid"})
        EXPECT_NE(one.out.find(word), std::string::npos) << one.out;
    const Result all = pcmlab("info --json --scan " + path("tiles"));
    ASSERT_EQ(all.code, 0) << all.err;
    EXPECT_EQ(Json::parse(all.out)["points"], 150);
    EXPECT_EQ(Json::parse(all.out)["scanned"]["points"], 150);
    EXPECT_EQ(Json::parse(all.out)["files"].size(), 2u);
}

TEST_F(CliTest, ADamagedTreeHasFaultsAndExitCodeOne)
{
    write_las(folder_ / "in.las", records(Shape::surface, 5000, 1), {});
    ASSERT_EQ(pcmlab("build " + path("in.las") + " -o " + path("out.pct")).code, 0);
    {
        std::fstream file(folder_ / "out.pct" / "chunks-000.bpc", std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(5000);
        file.put('#');
    }
    const Result result = pcmlab("verify --json " + path("out.pct"));
    EXPECT_EQ(result.code, 1);
    ASSERT_EQ(Json::parse(result.out)["faults"].size(), 1u);
    EXPECT_NE(Json::parse(result.out)["faults"][0].get<std::string>().find("chunks-000.bpc"), std::string::npos);
}

TEST_F(CliTest, BadInputSaysWhatAndWhereAndLeavesNothing)
{
    write_las(folder_ / "in.las", records(Shape::surface, 1000, 1), {});
    fs::resize_file(folder_ / "in.las", 10000);
    const Result truncated = pcmlab("build " + path("in.las") + " -o " + path("out.pct"));
    EXPECT_EQ(truncated.code, 1);
    EXPECT_NE(truncated.err.find("in.las"), std::string::npos) << truncated.err;
    EXPECT_NE(truncated.err.find("10000"), std::string::npos) << truncated.err;
    EXPECT_FALSE(fs::exists(folder_ / "out.pct"));
    EXPECT_FALSE(fs::exists(folder_ / "out.pct.part"));
    for (const char* command : {"info ", "verify "}) {
        const Result none = pcmlab(command + path(""));
        EXPECT_EQ(none.code, 1);
        EXPECT_NE(none.err.find(folder_.path().string()), std::string::npos) << none.err;
    }
    EXPECT_EQ(pcmlab("build " + path("missing.las")).code, 1);
    EXPECT_EQ(pcmlab("build").code, 2);
    EXPECT_EQ(pcmlab("dance").code, 2);
    EXPECT_EQ(pcmlab("build --memory nonsense " + path("in.las")).code, 2);
    EXPECT_EQ(pcmlab("--help").code, 0);
}

TEST_F(CliTest, OptionsOfExports)
{
    ASSERT_EQ(pcmlab("generate -n 1000 --no-truth " + path("in.las")).code, 0);
    const auto converted = [&](const std::string& output, const std::string& options) {
        return pcmlab("convert --overwrite " + path("in.las") + " " + path(output) + " " + options);
    };
    const auto begins = [&](const std::string& name) {
        std::ifstream file(folder_ / name, std::ios::binary);
        std::string bytes(100000, ' ');
        file.read(bytes.data(), 100000);
        return bytes;
    };
    for (const int minor : {0, 1, 2, 3, 4}) {
        ASSERT_EQ(converted("out.las", "--las-version 1." + std::to_string(minor)).code, 0);
        EXPECT_EQ(begins("out.las")[25], minor);
    }
    for (const char* wrong : {"1.5", "2.0", "1", "4", "1.22"}) {
        const Result refused = converted("out.las", std::string("--las-version ") + wrong);
        EXPECT_EQ(refused.code, 2);
        EXPECT_NE(refused.err.find("1.0, 1.1, 1.2, 1.3 or 1.4"), std::string::npos) << refused.err;
    }
    ASSERT_EQ(converted("out.ply", "--colour-bits 16").code, 0);
    EXPECT_NE(begins("out.ply").find("property ushort red"), std::string::npos);
    ASSERT_EQ(converted("out.ply", "--colour-bits 8").code, 0);
    EXPECT_NE(begins("out.ply").find("property uchar red"), std::string::npos);
    EXPECT_EQ(converted("out.ply", "--colour-bits 9").code, 2);
    ASSERT_EQ(converted("out.pcd", "--float-positions").code, 0);
    EXPECT_NE(begins("out.pcd").find("SIZE 4 4 4"), std::string::npos);
    EXPECT_EQ(begins("out.pcd").find("VIEWPOINT 0 0 0"), std::string::npos);
}

}  // namespace
