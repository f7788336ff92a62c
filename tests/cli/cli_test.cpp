// The pcm command as a user meets it: output, JSON, exit codes.

#include "clouds.h"
#include "support.h"

#include <nlohmann/json.hpp>

#include <sys/wait.h>

#include <array>
#include <fstream>
#include <cstdio>

namespace {

using namespace pcm::test;
using Json = nlohmann::json;
namespace fs = std::filesystem;

struct Result {
    int code = -1;
    std::string out, err;
};

class CliTest : public testing::Test {
protected:
    // Runs pcm with `arguments`, quoted for the shell by the caller where need be.
    Result pcm(const std::string& arguments)
    {
        const fs::path err = folder_ / "stderr.txt";
        const std::string command = std::string("'") + PCM_CLI + "' " + arguments + " 2>'" + err.string() + "'";
        Result result;
        FILE* pipe = popen(command.c_str(), "r");
        std::array<char, 4096> buffer;
        for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) result.out.append(buffer.data(), n);
        result.code = WEXITSTATUS(pclose(pipe));
        std::ifstream file(err);
        result.err.assign(std::istreambuf_iterator<char>(file), {});
        return result;
    }
    std::string path(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }
    TemporaryFolder folder_;
};

TEST_F(CliTest, GenerateBuildInfoVerify)
{
    const Result generated =
        pcm("generate -n 250000 --seed 7 --origin 5000000,4800000,100 --json " + path("scene.las"));
    ASSERT_EQ(generated.code, 0) << generated.err;
    EXPECT_EQ(Json::parse(generated.out)["points"], 250000);
    EXPECT_TRUE(fs::exists(folder_ / "scene.truth.json"));

    const Result built = pcm("build --json --memory 128M " + path("scene.las"));
    ASSERT_EQ(built.code, 0) << built.err;
    const Json build = Json::parse(built.out);
    EXPECT_EQ(build["points"], 250000);
    EXPECT_EQ(build["position_error"], 0);
    for (const char* key : {"seconds", "points_per_second", "peak_rss_bytes", "bytes"}) EXPECT_GT(build[key], 0) << key;
    EXPECT_TRUE(fs::exists(folder_ / "scene.pct" / "index.pct"));

    const Result asked = pcm("info --json " + path("scene.pct"));
    ASSERT_EQ(asked.code, 0) << asked.err;
    const Json info = Json::parse(asked.out);
    EXPECT_EQ(info["points"], 250000);
    EXPECT_EQ(info["scale"], Json({0.001, 0.001, 0.001}));
    EXPECT_GE(info["bounds"]["min"][0], 4999990.0);
    EXPECT_GT(info["levels"], 1);
    EXPECT_EQ(info["level"].size(), info["levels"]);
    EXPECT_EQ(info["level"].back()["points_to_here"], 250000);
    EXPECT_GT(info["level"][0]["spacing_max"], 0);
    EXPECT_EQ(info["bytes"], build["bytes"]);
    bool colour = false;
    for (const Json& attribute : info["attributes"])
        colour = colour || (attribute["name"] == "rgb" && attribute["type"] == "u16" && attribute["components"] == 3);
    EXPECT_TRUE(colour);

    const Result verified = pcm("verify --json " + path("scene.pct"));
    ASSERT_EQ(verified.code, 0) << verified.err;
    EXPECT_EQ(Json::parse(verified.out)["points"], 250000);
    EXPECT_TRUE(Json::parse(verified.out)["faults"].empty());

    // The same, for people.
    for (const char* command : {"info ", "verify "}) {
        const Result text = pcm(command + path("scene.pct"));
        EXPECT_EQ(text.code, 0);
        EXPECT_NE(text.out.find("250,000"), std::string::npos) << text.out;
    }
    // A tree is not overwritten unasked.
    const Result again = pcm("build " + path("scene.las"));
    EXPECT_EQ(again.code, 1);
    EXPECT_NE(again.err.find("scene.pct"), std::string::npos);
    EXPECT_EQ(pcm("build --overwrite " + path("scene.las")).code, 0);
}

TEST_F(CliTest, ADamagedTreeHasFaultsAndExitCodeOne)
{
    write_las(folder_ / "in.las", records(Shape::surface, 5000, 1), {});
    ASSERT_EQ(pcm("build " + path("in.las") + " -o " + path("out.pct")).code, 0);
    {
        std::fstream file(folder_ / "out.pct" / "chunks-000.bpc", std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(5000);
        file.put('#');
    }
    const Result result = pcm("verify --json " + path("out.pct"));
    EXPECT_EQ(result.code, 1);
    ASSERT_EQ(Json::parse(result.out)["faults"].size(), 1u);
    EXPECT_NE(Json::parse(result.out)["faults"][0].get<std::string>().find("chunks-000.bpc"), std::string::npos);
}

TEST_F(CliTest, BadInputSaysWhatAndWhereAndLeavesNothing)
{
    write_las(folder_ / "in.las", records(Shape::surface, 1000, 1), {});
    fs::resize_file(folder_ / "in.las", 10000);
    const Result truncated = pcm("build " + path("in.las") + " -o " + path("out.pct"));
    EXPECT_EQ(truncated.code, 1);
    EXPECT_NE(truncated.err.find("in.las"), std::string::npos) << truncated.err;
    EXPECT_NE(truncated.err.find("10000"), std::string::npos) << truncated.err;
    EXPECT_FALSE(fs::exists(folder_ / "out.pct"));
    EXPECT_FALSE(fs::exists(folder_ / "out.pct.part"));
    for (const char* command : {"info ", "verify "}) {
        const Result none = pcm(command + path(""));
        EXPECT_EQ(none.code, 1);
        EXPECT_NE(none.err.find(folder_.path().string()), std::string::npos) << none.err;
    }
    EXPECT_EQ(pcm("build " + path("missing.las")).code, 1);
    EXPECT_EQ(pcm("build").code, 2);
    EXPECT_EQ(pcm("dance").code, 2);
    EXPECT_EQ(pcm("build --memory nonsense " + path("in.las")).code, 2);
    EXPECT_EQ(pcm("--help").code, 0);
}

}  // namespace
