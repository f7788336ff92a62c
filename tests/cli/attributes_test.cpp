// pcmlab radii, normals, outliers: output, JSON, exit codes.

#include "tests/cli/command.h"

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class AttributesCliTest : public CommandTest {
protected:
    AttributesCliTest()
    {
        json("generate -n 30000 --seed 3 --json " + path("scene.las"));
        json("build --json " + path("scene.las"));
    }
    Json json(const std::string& arguments, int code = 0)
    {
        const Result result = pcmlab(arguments);
        EXPECT_EQ(result.code, code) << arguments << ": " << result.err;
        return result.out.empty() ? Json() : Json::parse(result.out);
    }
    std::vector<std::string> attributes_of(const std::string& tree)
    {
        std::vector<std::string> names;
        const Json info = json("info --json " + path(tree));
        for (const Json& attribute : info["attributes"]) names.push_back(attribute["name"]);
        return names;
    }
    bool has(const std::string& tree, const std::string& name)
    {
        const auto names = attributes_of(tree);
        return std::find(names.begin(), names.end(), name) != names.end();
    }
};

TEST_F(AttributesCliTest, NormalsAndRadiiInOnePass)
{
    const Json exact = json("normals --json " + path("scene.pct") + " -o " + path("n.pct") +
                            " --radii --curvature --mean-distance -k 12 --viewpoint 500010 4800010 110");
    EXPECT_EQ(exact["points"], 30000);
    EXPECT_GT(exact["flipped"], 0);
    EXPECT_GT(exact["seconds"], 0.0);
    EXPECT_GT(exact["peak_memory"], 1000000);
    for (const char* name : {"normal", "radius", "curvature", "mean_distance", "normal_confidence"})
        EXPECT_TRUE(has("n.pct", name)) << name;
    EXPECT_FALSE(has("scene.pct", "normal"));
    EXPECT_TRUE(json("verify --json " + path("n.pct"))["faults"].empty());

    const Json radii = json("radii --json --in-place " + path("n.pct") + " --max-distance 3");
    EXPECT_EQ(radii["error_kind"], "exact");
    EXPECT_EQ(radii["used_known_normals"], true);
    const Result text = pcmlab("radii " + path("scene.pct") + " -o " + path("r.pct"));
    EXPECT_NE(text.out.find(", exact"), std::string::npos) << text.out;
    EXPECT_FALSE(has("r.pct", "normal_confidence"));
    pcmlab("normals " + path("scene.pct") + " -o " + path("bare.pct") + " --no-confidence --direction 0 0 1");
    EXPECT_FALSE(has("bare.pct", "normal_confidence"));
    EXPECT_FALSE(has("bare.pct", "radius"));
}

TEST_F(AttributesCliTest, OutliersAreCountedLabelledAndRemoved)
{
    const std::string tree = path("scene.pct");
    const Json counted = json("outliers --json --count " + tree + " -a 1");
    const std::uint64_t outliers = counted["outliers"];
    EXPECT_GT(outliers, 100u);
    EXPECT_EQ(counted["done"], false);
    EXPECT_EQ(json("outliers --json --label " + tree + " -a 1 -o " + path("l.pct"))["outliers"], outliers);
    EXPECT_EQ(json("query --json " + path("l.pct") + " --where outlier=1")["points"], outliers);
    const Json removed = json("outliers --json " + tree + " -a 1 -o " + path("o.pct"));
    EXPECT_EQ(removed["points"], 30000 - outliers);
    EXPECT_EQ(removed["points_in"], 30000);
    EXPECT_NEAR(removed["threshold"], double(removed["centre"]) + double(removed["deviation"]), 1e-12);
    EXPECT_EQ(json("info --json " + path("o.pct"))["points"], 30000 - outliers);
    EXPECT_EQ(json("info --json " + tree)["points"], 30000);
    EXPECT_NE(json("outliers --json --count " + tree + " -a 1 --method robust")["outliers"], outliers);
    EXPECT_GT(json("outliers --json --count " + tree + " --method radius --radius 0.3 -k 3")["outliers"], 0);
    EXPECT_EQ(json("outliers --json --in-place " + path("o.pct") + " -a 1e9")["outliers"], 0);
}

TEST_F(AttributesCliTest, RefusesWhatMakesNoSense)
{
    const std::string tree = path("scene.pct");
    for (const std::string command : {"radii ", "normals ", "outliers "}) {
        const Result without_output = pcmlab(command + tree);
        EXPECT_EQ(without_output.code, 2) << command;
        for (const char* words : {"no output is given", "-o COPY", "--in-place"})
            EXPECT_NE(without_output.err.find(words), std::string::npos) << without_output.err;
    }
    EXPECT_EQ(pcmlab("radii " + tree + " -o " + tree).code, 1);
    EXPECT_EQ(pcmlab("radii " + tree + " --in-place -o " + path("r.pct")).code, 2);
    EXPECT_EQ(pcmlab("radii " + tree + " --in-place -k 0").code, 2);
    EXPECT_EQ(pcmlab("radii " + tree + " --in-place --max-distance 0").code, 2);
    EXPECT_EQ(pcmlab("normals " + tree + " --in-place --viewpoint 1 2 3 --direction 0 0 1").code, 2);
    EXPECT_EQ(pcmlab("normals " + tree + " --in-place --direction 0 0 0").code, 1);
    EXPECT_EQ(pcmlab("outliers " + tree + " --in-place --method radius").code, 2);
    EXPECT_EQ(pcmlab("outliers " + tree + " --in-place --radius 1").code, 2);
    EXPECT_EQ(pcmlab("outliers " + tree + " --in-place --method other").code, 2);
    EXPECT_EQ(pcmlab("outliers " + tree + " --in-place -a nan").code, 1);
    for (const char* factor : {"-1", "0"}) {
        const Result refused = pcmlab("outliers " + tree + " --in-place -a " + factor);
        EXPECT_EQ(refused.code, 1);
        EXPECT_NE(refused.err.find("about half of the points or more"), std::string::npos) << refused.err;
        EXPECT_NE(refused.err.find("give a positive factor"), std::string::npos) << refused.err;
    }
    for (const char* command : {"radii", "normals", "outliers"}) {
        const Result small = pcmlab(command + (" " + tree) + " --in-place -m 63M");
        EXPECT_EQ(small.code, 1) << command;
        const std::string least = std::string(command) == "outliers" ? "64M" : "96M";
        EXPECT_NE(small.err.find("give -m " + least + " or more"), std::string::npos) << small.err;
    }
    EXPECT_EQ(json("info --json " + tree)["generation"], 1);
}

// What a person does with a new scan.
TEST_F(AttributesCliTest, FromLasToDiscsInOneLine)
{
    const Result result =
        pcmlab("build " + path("scene.las") + " -o " + path("new.pct") + " && '" + std::string(pcm::paths::command) +
               "' normals " + path("new.pct") + " --in-place --radii");
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_TRUE(has("new.pct", "normal"));
    EXPECT_TRUE(has("new.pct", "radius"));
}

}  // namespace
