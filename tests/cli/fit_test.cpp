// pcmlab fit as a user meets it, on a pipe over a floor.

#include "pcm/system/cpu.h"
#include "tests/cli/command.h"
#include "tests/faults.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <fstream>
#include <regex>

namespace {

using namespace pcm::test;
using ::pcm::ShapeKind;
using ::pcm::Vec3d;

class FitCommand : public CommandTest {
protected:
    void SetUp() override
    {
        Dice dice(1);
        pipe_.kind = ShapeKind::cylinder;
        pipe_.point = {-3, -40, 10};
        pipe_.axis = {1, 0, 0};
        pipe_.radius = 0.25;
        pcm::Shape floor;
        floor.point = {2, -40, 9};
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 12000; ++i) points.push_back(point_on(pipe_, 10, 2 * pcm::pi, 0.002, dice));
        for (int i = 0; i < 12000; ++i) points.push_back(point_on(floor, 6, 0, 0.002, dice));
        build_surface_tree(folder_.path(), points);
    }
    Json fit(const std::string& arguments)
    {
        const Result result = pcmlab("fit --json " + path("surface.pct") + " " + arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
    void refused(const std::string& arguments, int code, const std::string& part)
    {
        const Result result = pcmlab("fit " + path("surface.pct") + " " + arguments);
        EXPECT_EQ(result.code, code) << arguments << result.err;
        EXPECT_NE((result.out + result.err).find(part), std::string::npos)
            << arguments << ": " << result.out << result.err;
    }
    std::uint64_t points_of(const std::string& name)
    {
        const Result result = pcmlab("info --json " + path(name));
        EXPECT_EQ(result.code, 0) << result.err;
        return Json::parse(result.out).value("points", std::uint64_t(0));
    }
    pcm::Shape pipe_;
    const std::string at_ = "--at '2 -39.75 10' ";
};

TEST_F(FitCommand, ClickOnAPipeAndGetThePipe)
{
    const Json json = fit(at_);
    const Json& primitive = json["primitive"];
    EXPECT_EQ(primitive["kind"], "cylinder");
    EXPECT_EQ(primitive["verdict"], "good");
    EXPECT_LT(std::fabs(primitive["radius"].get<double>() - 0.25), 4 * primitive["sigma"]["radius"].get<double>());
    EXPECT_LT(primitive["sigma"]["radius"].get<double>(), 0.0001);
    EXPECT_GT(json["points"], 11850);
    EXPECT_LT(json["points"], 12050);
    EXPECT_EQ(primitive["points"], json["points"]);
    EXPECT_EQ(json["growth"]["converged"], true);
    EXPECT_GT(json["seconds"], 0);
    EXPECT_GT(json["peak_memory"], 0);
    EXPECT_TRUE(json["done"].is_null());
    const Result text = pcmlab("fit " + path("surface.pct") + " " + at_);
    EXPECT_EQ(text.code, 0) << text.err;
    for (const char* part : {"Cylinder: good", "radius", " +- ", "length", "noise", "points belong to it",
                             " (95 %, of the shape's place); ", "peak memory"})
        EXPECT_NE(text.out.find(part), std::string::npos) << part << text.out;
    EXPECT_FALSE(std::regex_search(text.out, std::regex("\\.[0-9]{9}"))) << text.out;
}

// With all kinds, those that PCL has are fitted.
// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(FitCommand, PCM_NOT_UNDER_ADDRESS(IsTheSameWithAllVectorInstructions))
{
    std::string first;
    for (const pcm::SimdLevel level : pcm::simd_levels()) {
        const std::string name(pcm::name_of(level));
        const Result result = pcmlab("fit --json " + path("surface.pct") + " " + at_, "PCM_SIMD=" + name);
        ASSERT_EQ(result.code, 0) << result.err;
        Json json = Json::parse(result.out)["primitive"];
        json.erase("seconds");
        const std::string primitive = json.dump();
        ASSERT_GT(primitive.size(), 100u);
        if (first.empty()) first = primitive;
        EXPECT_EQ(primitive, first) << name;
    }
}

TEST_F(FitCommand, TheBackendPclLeavesOutWhatItHasNot)
{
    const Result result = pcmlab("fit " + path("surface.pct") + " " + at_ + " --shape any --backend pcl");
    if (result.err.find("PCL is not here") != std::string::npos) GTEST_SKIP() << result.err;
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("Cylinder: good"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("note: the backend PCL has no torus: it is left out"), std::string::npos) << result.out;
    refused(at_ + "--shape torus --backend pcl", 1, "the backend PCL has no torus");
}

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(FitCommand, PCM_NOT_UNDER_ADDRESS(PlacesMayBeWrittenInSeveralWays))
{
    const double radius = fit(at_)["primitive"]["radius"];
    for (const char* at : {"--at 2 -39.75 10", "--at 2,-39.75,10", "--at '2, -39.75, 10'"})
        EXPECT_EQ(fit(at)["primitive"]["radius"], radius) << at;
    const Json two = fit("--at '2 -39.75 10' --at '4 -39.75 10' --count 300");
    EXPECT_EQ(two["neighbourhood"]["points"], 600);
    EXPECT_EQ(fit("--at 2 -39.75 10 4 -39.75 10 --count 300")["neighbourhood"]["points"], 600);
    const Json part = fit(at_ + "--radius 0.5 --not-at '4 -39.75 10'");
    EXPECT_LT(part["points"], 11600);
}

TEST_F(FitCommand, OptionsAreTaken)
{
    EXPECT_EQ(fit(at_ + "--shape plane --no-grow --count 40")["primitive"]["kind"], "plane");
    EXPECT_TRUE(fit(at_ + "--shape cylinder --no-grow")["growth"].is_null());
    const Json json =
        fit(at_ +
            "--shape cylinder --estimator ransac --threshold 0.009 --iterations 500 --probability 0.999 "
            "--time-limit 5 --seed 7 --count 800 --step 0.2 --rounds 2 --least-radius 0.1 --largest-radius 1 "
            "--outline convex --clip 'box -3 -50 0 3 -30 20' -t 1 -m 64M");
    EXPECT_EQ(json["primitive"]["estimator"], "ransac");
    EXPECT_EQ(json["primitive"]["threshold"], 0.009);
    EXPECT_EQ(json["neighbourhood"]["points"], 800);
    EXPECT_EQ(json["growth"]["step"], 0.2);
    EXPECT_LE(json["growth"]["rounds"], 2);
    EXPECT_LT(json["points"], 7500);
    EXPECT_GT(json["points"], 6500);
}

TEST_F(FitCommand, WhatMakesNoSenseIsRefused)
{
    refused("", 2, "--at");
    refused("--at '1 2'", 2, "takes x y z of each point");
    refused("--at 'here'", 2, "is not a number");
    refused(at_ + "--radius 1 --count 5", 2, "--radius and --count");
    refused(at_ + "--no-grow --step 1", 2, "--no-grow");
    refused(at_ + "--name Pipe", 2, "--add");
    refused(at_ + "--outline convex --outline-edge 1", 2, "--outline concave");
    refused(at_ + "--shape cube", 2, "cube");
    refused(at_ + "--delete", 2, "-o COPY");
    refused(at_ + "--probability 2", 2, "probability");
    refused(at_ + "--add list.txt", 1, ".json");
    // Before the tree is opened.
    const Result result = pcmlab("fit " + path("nowhere.pct") + " " + at_ + "--add list.txt");
    EXPECT_NE(result.err.find(".json"), std::string::npos) << result.err;
    refused(at_ + "--not-at '2 -39.75 10'", 1, "was given both as one on the surface and as one off it");
}

// A refusal is a result: printed, with the exit code of a failure, and nothing is done.
TEST_F(FitCommand, ARefusedFitDoesNothing)
{
    const std::string arguments =
        "--at '100 100 100' --radius 1 --add " + path("list.json") + " --extract " + path("part.las");
    refused(arguments, 1, "refused");
    const Result result = pcmlab("fit --json " + path("surface.pct") + " " + arguments);
    EXPECT_EQ(result.code, 1);
    const Json json = Json::parse(result.out);
    EXPECT_EQ(json["primitive"]["verdict"], "refused");
    EXPECT_EQ(json["points"], 0);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "part.las"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "list.json"));
}

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(FitCommand, PCM_NOT_UNDER_ADDRESS(AddsToAList))
{
    const std::string list = " --add " + path("list.json");
    EXPECT_EQ(fit(at_ + list)["primitive"]["name"], "Cylinder 1");
    EXPECT_EQ(fit("--at '2 -38 9' --shape plane --name Floor" + list)["primitive"]["name"], "Floor");
    const Result text = pcmlab("fit " + path("surface.pct") + " " + at_ + list);
    EXPECT_NE(text.out.find("Cylinder 2 added"), std::string::npos) << text.out;
    std::ifstream file(folder_ / "list.json");
    const Json json = Json::parse(file);
    ASSERT_EQ(json["primitives"].size(), 3u);
    EXPECT_EQ(json["primitives"][1]["name"], "Floor");
    for (int i = 0; i < 3; ++i)
        EXPECT_NE(json["primitives"][i]["colour"], json["primitives"][(i + 1) % 3]["colour"]) << i;
    // What is not a list is not changed.
    std::ofstream(folder_ / "other.json") << "{}";
    refused(at_ + "--add " + path("other.json"), 1, "other.json");
    std::ifstream other(folder_ / "other.json");
    std::string content;
    std::getline(other, content);
    EXPECT_EQ(content, "{}");
}

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(FitCommand, PCM_NOT_UNDER_ADDRESS(ItsPointsAreExtractedSavedAndDeleted))
{
    const std::uint64_t points = fit(at_ + "--extract " + path("pipe.las"))["points"];
    EXPECT_EQ(points_of("pipe.las"), points);
    refused(at_ + "--extract " + path("pipe.las"), 1, "exists");
    EXPECT_EQ(fit(at_ + "--extract " + path("pipe.pct"))["done"], "extracted");
    EXPECT_EQ(points_of("pipe.pct"), points);
    const Json removed = fit(at_ + "--delete -o " + path("rest.pct"));
    EXPECT_EQ(removed["points_changed"], points);
    EXPECT_EQ(points_of("rest.pct"), 24000 - points);
    EXPECT_EQ(points_of("surface.pct"), 24000u);
    fit(at_ + "--save-attribute pipe --in-place");
    const Result selected = pcmlab("select --json " + path("surface.pct") + " --where pipe=1");
    EXPECT_EQ(Json::parse(selected.out)["points"], points);
}

// A full disk leaves the tree as it was, and no half of an output.
// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(FitCommand, PCM_NOT_UNDER_ADDRESS(AFullDiskChangesNothing))
{
    const std::filesystem::path work = folder_ / "work";
    std::filesystem::create_directory(work);
    std::filesystem::copy(folder_ / "surface.pct", work / "a.pct", std::filesystem::copy_options::recursive);
    const std::vector<std::string> base{pcm::paths::command, "fit", (work / "a.pct").string(), "--at", "2,-39.75,10"};
    const auto with = [&](std::initializer_list<std::string> more) {
        std::vector<std::string> command = base;
        command.insert(command.end(), more);
        return command;
    };
    const std::vector<std::vector<std::string>> commands{
        with({"--extract", (work / "p.las").string()}),   with({"--extract", (work / "p.pct").string()}),
        with({"--save-attribute", "pipe", "--in-place"}), with({"--delete", "--in-place"}),
        with({"--add", (work / "list.json").string()}),
    };
    for (const std::vector<std::string>& command : commands) {
        SCOPED_TRACE(command[5]);
        for (const long at : {1L, 2L, 3L, 5L}) {
            const Faulty full = run_with_fault(command, work, "full", at);
            if (full.code == 0) continue;  // it made fewer calls
            EXPECT_EQ(full.code, 1) << full.err;
            EXPECT_FALSE(std::filesystem::exists(work / "p.las"));
            EXPECT_FALSE(std::filesystem::exists(work / "p.pct"));
            EXPECT_FALSE(std::filesystem::exists(work / "list.json"));
            const Result verified = pcmlab("verify --json '" + (work / "a.pct").string() + "'");
            EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
            EXPECT_EQ(points_of("work/a.pct"), 24000u);
            const Result none = pcmlab("select '" + (work / "a.pct").string() + "' --where pipe=1");
            EXPECT_NE(none.code, 0);  // there is no such attribute
        }
        EXPECT_NE(run_with_fault(command, work, "full", 1).code, 0) << "no fault was met";
    }
    // Repeated, it would add the primitive once more.
    const std::filesystem::path list = folder_ / "kept.json";
    const Faulty half = run_with_fault(with({"--add", list.string(), "--delete", "--in-place"}), work, "full", 1);
    EXPECT_EQ(half.code, 3) << half.err;
    for (const char* words : {"kept.json", "was added, but", "space", "do not repeat"})
        EXPECT_NE(half.err.find(words), std::string::npos) << half.err;
    EXPECT_TRUE(std::filesystem::exists(list));
    EXPECT_EQ(points_of("work/a.pct"), 24000u);
}

}  // namespace
