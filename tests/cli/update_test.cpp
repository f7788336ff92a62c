// pcmlab append, delete, compact, repair: output, JSON, exit codes.

#include "tests/cli/command.h"
#include "tests/faults.h"

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

TEST_F(UpdateCliTest, ADamagedAboutIsDamageForVerifyAndForRepair)
{
    json("generate -n 5000 --json " + path("scene.las"));
    json("build --json " + path("scene.las"));
    EXPECT_EQ(json("repair --check --json " + path("scene.pct"))["verified"], true);
    std::fstream(folder_ / "scene.pct/about.pct", std::ios::in | std::ios::out | std::ios::binary).seekp(100).put('x');
    json("verify --json " + path("scene.pct"), 1);
    const Json checked = json("repair --check --json " + path("scene.pct"), 1);
    EXPECT_EQ(checked["whole"], false);
    EXPECT_EQ(checked["verified"], false);
    EXPECT_EQ(checked["restored"].size(), 1u);
    EXPECT_NE(pcmlab("repair --check " + path("scene.pct")).out.find("about.pct"), std::string::npos);
    const Result repaired = pcmlab("repair " + path("scene.pct"));
    EXPECT_EQ(repaired.code, 0);
    EXPECT_NE(repaired.out.find("restored from the index"), std::string::npos) << repaired.out;
    EXPECT_NE(repaired.out.find("verified"), std::string::npos) << repaired.out;
    json("verify --json " + path("scene.pct"));
    json("repair --check --json " + path("scene.pct"));
}

// The index was replaced, and flushing the folder failed: a second append would double the points.
TEST_F(UpdateCliTest, AnUpdateThatMayNotLastIsReportedAsDone)
{
    json("generate -n 5000 --json " + path("scene.las"));
    json("build --json " + path("scene.las"));
    fs::copy(folder_ / "scene.pct", folder_ / "again.pct");
    const std::string las = (folder_ / "scene.las").string();
    const auto append = [&](const char* tree) {
        return std::vector<std::string>{pcm::paths::command, "append", (folder_ / tree).string(), las, "-t", "1"};
    };
    // Counted from the end: what follows removes the scratch files.
    const long calls = count_calls(append("again.pct"), folder_ / "again.pct");
    std::string last_words;
    for (long at = calls; at > 0; --at) {
        fs::remove_all(folder_ / "again.pct");
        fs::copy(folder_ / "scene.pct", folder_ / "again.pct");
        // A sanitized command expects its runtime to be loaded first.
        const Result result =
            pcmlab("append --json " + path("again.pct") + " " + path("scene.las") + " -t 1",
                   std::string("ASAN_OPTIONS=\"$ASAN_OPTIONS:verify_asan_link_order=0:detect_leaks=0\" LD_PRELOAD='") +
                       pcm::paths::faults + "' PCM_FAULT=eio PCM_FAULT_AT=" + std::to_string(at) +
                       " PCM_FAULT_UNDER=" + path("again.pct"));
        last_words = result.err;
        if (last_words.find("flushing the folder") == std::string::npos) continue;
        EXPECT_EQ(result.code, 3) << last_words;
        EXPECT_NE(last_words.find("the update is part of the tree"), std::string::npos) << last_words;
        EXPECT_NE(last_words.find("do not repeat"), std::string::npos) << last_words;
        const Json report = Json::parse(result.out);
        EXPECT_EQ(report["points_added"], 5000);
        EXPECT_EQ(report["points"], 10000);
        EXPECT_EQ(report["warnings"].size(), 1u);
        EXPECT_EQ(json("info --json " + path("again.pct"))["points"], 10000);
        return;
    }
    FAIL() << last_words;
}

// RLIMIT_FSIZE: the signal does not end the command, and what was begun is removed.
TEST_F(UpdateCliTest, ALimitOfTheFileSizeIsAnError)
{
    json("generate -n 20000 --no-truth --json " + path("scene.las"));
    json("build --json " + path("scene.las"));
    fs::create_directory(folder_ / "out");
    const std::string tree_before = pcmlab("verify -q " + path("scene.pct")).out.substr(0, 40);
    for (const std::string& command :
         {"convert " + path("scene.las") + " " + path("out/a.xyz"),
          "convert " + path("scene.las") + " " + path("out/a.laz"),
          "build " + path("scene.las") + " -o " + path("out/a.pct"),
          "append " + path("scene.pct") + " " + path("scene.las"), "set " + path("scene.pct") + " intensity=3",
          "generate -n 50000 --no-truth " + path("out/a.las")}) {
        const Result result = pcmlab(command, "ulimit -f 40;");
        EXPECT_EQ(result.code, 1) << command << ": " << result.err;
        EXPECT_NE(result.err.find("ulimit -f"), std::string::npos) << command << ": " << result.err;
        EXPECT_TRUE(fs::is_empty(folder_ / "out")) << command;
    }
    EXPECT_EQ(pcmlab("verify -q " + path("scene.pct")).out.substr(0, 40), tree_before);
    EXPECT_EQ(points(), 20000u);
}

}  // namespace
