// Commands whose result is another cloud: voxel, subsample, merge.

#include "tests/cli/command.h"
#include "tests/sanitizers.h"

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class ResultCommands : public CommandTest {
protected:
    Json json_of(const std::string& arguments)
    {
        const Result result = pcmlab(arguments + " --json");
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
};

TEST_F(ResultCommands, VoxelGridOfAFileAndOfATree)
{
    ASSERT_EQ(pcmlab("generate -n 30000 " + path("a.las")).code, 0);
    ASSERT_EQ(pcmlab("build " + path("a.las") + " -m 128M").code, 0);
    const Json of_file = json_of("voxel -s 0.5 " + path("a.las") + " -o " + path("one.pct") + " -m 128M --count");
    const Json of_tree = json_of("voxel -s 0.5 " + path("a.pct") + " -o " + path("two.pct") + " -m 128M --count");
    EXPECT_EQ(of_file["points_in"], 30000);
    EXPECT_LT(of_file["points"], 30000);
    EXPECT_EQ(of_file["points"], of_tree["points"]);
    EXPECT_EQ(of_file["most_points_in_a_voxel"], of_tree["most_points_in_a_voxel"]);
    for (const char* key : {"seconds", "peak_memory", "bytes"}) EXPECT_GT(of_tree[key], 0) << key;
    EXPECT_EQ(json_of("verify " + path("one.pct"))["points"], of_file["points"]);
    const Json anchored =
        json_of("voxel " + path("a.pct") + " -s 0.5 --anchor 0.25 0 0 -o " + path("three.pct") + " -m 128M --nearest");
    EXPECT_NE(anchored["points"], of_tree["points"]);
    const Json info = json_of("info " + path("three.pct"));
    EXPECT_EQ(info["scale"], json_of("info " + path("a.pct"))["scale"]);
    const Result again = pcmlab("voxel -s 0.5 " + path("a.las") + " -o " + path("one.pct"));
    EXPECT_EQ(again.code, 1);
    EXPECT_NE(again.err.find("something of this name already"), std::string::npos) << again.err;
    EXPECT_EQ(json_of("voxel -s 0.5 --in-place -m 128M " + path("a.pct"))["points"], of_tree["points"]);
    EXPECT_EQ(json_of("info " + path("a.pct"))["points"], of_tree["points"]);
}

TEST_F(ResultCommands, SubsampleToALevelASpacingAndANumber)
{
    ASSERT_EQ(pcmlab("generate -n 30000 " + path("a.las")).code, 0);
    ASSERT_EQ(pcmlab("build " + path("a.las") + " -m 128M").code, 0);
    const Json levels = json_of("info " + path("a.pct"))["level"];
    const double spacing = levels[1]["spacing"];
    const Json level = json_of("subsample " + path("a.pct") + " -s " + std::to_string(spacing * 1.1) + " -o " +
                               path("one.pct") + " -m 128M --nearest-level");
    EXPECT_EQ(level["level"], 1);
    EXPECT_EQ(level["spacing"], levels[1]["spacing"]);
    EXPECT_EQ(level["points"], levels[1]["points_to_here"]);
    EXPECT_EQ(level["points_in"], 30000);
    const Json exact = json_of("subsample " + path("a.las") + " -s 0.7 -o " + path("two.pct") + " -m 128M");
    EXPECT_EQ(exact["spacing"], 0.7);
    EXPECT_TRUE(exact["level"].is_null());
    EXPECT_EQ(json_of("verify " + path("two.pct"))["points"], exact["points"]);
    const Json number = json_of("subsample --in-place -n 12345 --exact " + path("a.pct") + " -m 128M");
    EXPECT_EQ(number["points"], 12345);
    EXPECT_EQ(json_of("info " + path("a.pct"))["points"], 12345);
    EXPECT_EQ(pcmlab("subsample " + path("a.pct") + " -o " + path("b.pct")).code, 2);
    EXPECT_EQ(pcmlab("subsample -n 3 -s 3 " + path("a.pct") + " -o " + path("b.pct")).code, 2);
    EXPECT_EQ(pcmlab("subsample -n 3 " + path("a.pct")).code, 2);
    const Result text = pcmlab("subsample " + path("two.pct") + " -s 5 --nearest-level -o " + path("c.pct"));
    EXPECT_NE(text.out.find("level "), std::string::npos) << text.out;
}

TEST_F(ResultCommands, MergeOfTrees)
{
    for (const std::string name : {"a", "b"}) {
        ASSERT_EQ(pcmlab("generate -n 5000 --seed " + std::to_string(name[0]) + " " + path(name + ".las")).code, 0);
        ASSERT_EQ(pcmlab("build " + path(name + ".las") + " -m 128M").code, 0);
    }
    const Json json = json_of("merge " + path("c.pct") + " " + path("a.pct") + " " + path("b.pct") + " --source-id");
    EXPECT_EQ(json["points"], 10000);
    EXPECT_EQ(json["points_in"], 10000);
    EXPECT_EQ(json["trees"], Json({"a.pct", "b.pct"}));
    EXPECT_EQ(json["largest_rounding"], 0);
    EXPECT_EQ(json["grid"]["scale"], Json({0.001, 0.001, 0.001}));
    EXPECT_EQ(json_of("verify " + path("c.pct"))["points"], 10000);
    EXPECT_EQ(json_of("query " + path("c.pct") + " --where source_id=2")["points"], 5000);
    const Result again = pcmlab("merge " + path("c.pct") + " " + path("a.pct"));
    EXPECT_EQ(again.code, 1);
    EXPECT_NE(again.err.find("already"), std::string::npos) << again.err;
    const Result text = pcmlab("merge --overwrite " + path("c.pct") + " " + path("a.pct"));
    EXPECT_NE(text.out.find("of 1 trees"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("coordinate system: "), std::string::npos) << text.out;
    EXPECT_EQ(pcmlab("merge " + path("c.pct")).code, 2);
    // The output by its name, wherever it stands.
    const std::string trees = path("a.pct") + " " + path("b.pct"), output = path("d.pct");
    for (const std::string& words :
         {trees + " -o " + output, "-o " + output + " " + trees, trees + " -o" + output, trees + " --output=" + output,
          path("a.pct") + " --output " + output + " " + path("b.pct")}) {
        const Json named = json_of("merge --overwrite " + words);
        EXPECT_EQ(named["trees"], Json({"a.pct", "b.pct"})) << words;
        EXPECT_EQ(named["output"], (folder_ / "d.pct").string()) << words;
    }
    EXPECT_EQ(json_of("query " + path("a.pct"))["points"], 5000);
    for (const std::string wrong : {"-o", "--output"}) {
        const Result missing = pcmlab("merge " + trees + " " + wrong);
        EXPECT_EQ(missing.code, 2);
        EXPECT_NE(missing.err.find("needs a value"), std::string::npos) << missing.err;
    }
}

TEST_F(ResultCommands, VoxelGridsThatAreRefused)
{
    ASSERT_EQ(pcmlab("generate -n 1000 " + path("a.las")).code, 0);
    EXPECT_EQ(pcmlab("voxel -s 1 " + path("a.las")).code, 2);                      // no output
    EXPECT_EQ(pcmlab("voxel -s 1 --in-place " + path("a.las")).code, 2);           // no tree
    EXPECT_EQ(pcmlab("voxel " + path("a.las") + " -o " + path("b.pct")).code, 2);  // no size
    for (const std::string size : {"0", "-3", "nan", "1e-9"}) {
        const Result result = pcmlab("voxel -s=" + size + " " + path("a.las") + " -o " + path("b.pct"));
        EXPECT_NE(result.code, 0) << size;
        EXPECT_FALSE(fs::exists(folder_ / "b.pct"));
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            EXPECT_NE(entry.path().filename().string().rfind("b.pct", 0), 0u) << entry.path();
    }
}

// A tree with the name that temporary trees once had.
TEST_F(ResultCommands, ATreeOfTheUsersIsNotRemoved)
{
    ASSERT_EQ(pcmlab("generate -n 5000 " + path("a.las")).code, 0);
    ASSERT_EQ(pcmlab("build " + path("a.las") + " -o " + path("o.pct.input") + " -m 128M").code, 0);
    for (const std::string command : {"voxel -s 0.5 ", "subsample -n 1000 "}) {
        json_of(command + path("a.las") + " -o " + path("o.pct") + " -m 128M --overwrite");
        EXPECT_EQ(json_of("verify " + path("o.pct.input"))["points"], 5000) << command;
    }
}

// Three million points with a limit of 128 MiB. Sanitizers need more memory: their presets leave this out.
// Not under the address sanitizer: a limit of memory, of which the sanitizer takes more itself.
TEST_F(ResultCommands, PCM_NOT_UNDER_ADDRESS(VoxelGridKeepsToItsMemory))
{
    ASSERT_EQ(pcmlab("generate -n 3000000 " + path("a.las")).code, 0);
    ASSERT_EQ(pcmlab("build --fast " + path("a.las") + " -m 128M").code, 0);
    for (const std::string size : {"0.01", "5", "10000"}) {
        const Json json =
            json_of("voxel -s " + size + " " + path("a.pct") + " -o " + path("grid" + size + ".pct") + " -m 128M -t 2");
        EXPECT_LT(json["peak_memory"], 192 << 20) << size;
    }
}

}  // namespace
