// pcmlab append, delete, compact, repair: output, JSON, exit codes.

#include "tests/cli/command.h"

#include <fstream>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class UpdateCliTest : public CommandTest {
protected:
    Json json(const std::string& arguments, int code = 0)
    {
        const Result result = pcmlab(arguments);
        EXPECT_EQ(result.code, code) << arguments << ": " << result.err;
        return result.out.empty() ? Json() : Json::parse(result.out);
    }
    std::uint64_t points() { return json("info --json " + path("scene.pct"))["points"]; }
    void expect_whole() { EXPECT_TRUE(json("verify --levels --json " + path("scene.pct"))["faults"].empty()); }
};

TEST_F(UpdateCliTest, AppendDeleteCompactRepair)
{
    json("generate -n 30000 --seed 3 --json " + path("scene.las"));
    json("generate -n 20000 --seed 4 --json " + path("more.las"));
    json("build --json " + path("scene.las"));

    const Json appended = json("append --json " + path("scene.pct") + " " + path("more.las"));
    EXPECT_EQ(appended["points_added"], 20000);
    EXPECT_EQ(appended["points"], 50000);
    EXPECT_EQ(appended["parts"], 2);
    expect_whole();

    const std::string half = " --where \"x<500002\"";
    const Json counted = json("delete --count --json " + path("scene.pct") + half);
    const std::uint64_t deleted = counted["points_deleted"];
    EXPECT_GT(deleted, 0u);
    EXPECT_LT(deleted, 50000u);
    EXPECT_EQ(counted["done"], false);
    EXPECT_EQ(points(), 50000u);
    const Json done = json("delete --json " + path("scene.pct") + half);
    EXPECT_EQ(done["points_deleted"], deleted);
    EXPECT_EQ(done["points"], 50000 - deleted);
    EXPECT_EQ(points(), 50000 - deleted);
    expect_whole();
    const Json info = json("info --json " + path("scene.pct"));
    EXPECT_EQ(info["generation"], 3);
    EXPECT_EQ(info["parts"], 2);
    EXPECT_EQ(info["coverage_kept"], false);
    EXPECT_NE(pcmlab("info " + path("scene.pct")).out.find("pcmlab compact"), std::string::npos);

    fs::remove(folder_ / "scene.pct" / "index.pct");
    EXPECT_EQ(json("repair --check --json " + path("scene.pct"), 1)["index_written"], false);
    EXPECT_EQ(json("repair --json " + path("scene.pct"))["points_lost"], 0);
    EXPECT_EQ(points(), 50000 - deleted);
    EXPECT_EQ(json("repair --check --json " + path("scene.pct"))["whole"], true);

    const Json compacted = json("compact --json " + path("scene.pct"));
    EXPECT_EQ(compacted["points"], 50000 - deleted);
    EXPECT_LT(compacted["bytes"], compacted["bytes_before"]);
    expect_whole();
    EXPECT_EQ(json("info --json " + path("scene.pct"))["coverage_kept"], true);
}

TEST_F(UpdateCliTest, ReportsWhatItDoesAndWhyItRefuses)
{
    json("generate -n 5000 --json " + path("scene.las"));
    json("build --json " + path("scene.las"));
    const Result nothing = pcmlab("delete " + path("scene.pct"));
    EXPECT_EQ(nothing.code, 1);
    EXPECT_NE(nothing.err.find("no points were chosen"), std::string::npos) << nothing.err;
    const Result sphere = pcmlab("delete " + path("scene.pct") + " --sphere 500001 4800001 100 1.5");
    EXPECT_EQ(sphere.code, 0) << sphere.err;
    EXPECT_NE(sphere.out.find("points deleted"), std::string::npos) << sphere.out;
    const Result off = pcmlab("append " + path("scene.pct") + " " + path("scene.las") + " -m 1M");
    EXPECT_EQ(off.code, 1);
    EXPECT_NE(off.err.find("64 MiB"), std::string::npos) << off.err;
    std::ofstream(folder_ / "other.xyz") << "1 2 3\n4 5 6.00001\n";
    const Result other = pcmlab("append " + path("scene.pct") + " " + path("other.xyz"));
    EXPECT_EQ(other.code, 1);
    EXPECT_NE(other.err.find("no place on the tree's grid"), std::string::npos) << other.err;
    EXPECT_EQ(pcmlab("compact " + path("none.pct")).code, 1);
    EXPECT_EQ(pcmlab("repair " + path("none.pct")).code, 1);
}

}  // namespace
