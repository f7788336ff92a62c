// Commands that measure: measure, profile, volume.

#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#include <cmath>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class MeasureCommands : public CommandTest {
protected:
    Json json_of(const std::string& arguments)
    {
        const Result result = pcmlab(arguments + " --json");
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
    // The words are in the error output, and the exit code is this.
    void expect_refused(const std::string& arguments, int code, const std::string& words)
    {
        const Result result = pcmlab(arguments);
        EXPECT_EQ(result.code, code) << arguments << "\n" << result.out;
        EXPECT_NE(result.err.find(words), std::string::npos) << arguments << "\n" << result.err;
    }
    void make_tree(const std::string& name, int seed)
    {
        ASSERT_EQ(pcmlab("generate -n 30000 --seed " + std::to_string(seed) + " " + path(name + ".las")).code, 0);
        ASSERT_EQ(pcmlab("build " + path(name + ".las") + " -m 128M").code, 0);
    }
    std::string text_in(const std::string& name)
    {
        std::ifstream file(folder_ / name);
        return {std::istreambuf_iterator<char>(file), {}};
    }
};

TEST_F(MeasureCommands, MeasuresAtPointsAndKeepsLists)
{
    const Json one = json_of("measure distance -p 500000 4800000 100 500003 4800004 100 -o " + path("a.json"));
    EXPECT_EQ(one["measures"][0]["values"]["distance"]["value"], 5);
    EXPECT_EQ(one["measures"][0]["name"], "Distance 1");
    const Json two = json_of("measure surface --surface 'sphere 0 0 0 2' -p 0 3 4 --name ball --list " +
                             path("a.json") + " -o " + path("b.json") + " -o " + path("b.csv"));
    ASSERT_EQ(two["measures"].size(), 2u);
    EXPECT_EQ(two["measures"][1]["values"]["distance"]["value"], 3);
    const Json both = json_of("measure --list " + path("b.json"));
    ASSERT_EQ(both["measures"].size(), 2u);
    EXPECT_EQ(both["measures"][1]["name"], "ball");
    EXPECT_EQ(both["measures"][1]["values"]["distance"]["value"], 3);
    EXPECT_NE(text_in("b.csv").find("ball,surface,distance,3,0,"), std::string::npos);
    const Result text = pcmlab("measure area -p 0 0 -1 4 0 -1 4 3 -1");
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_NE(text.out.find("plan area          6"), std::string::npos) << text.out;
}

TEST_F(MeasureCommands, SnapsToTheNearestPoints)
{
    make_tree("a", 1);
    const Json json = json_of("measure distance --from " + path("a.pct") + " -p 500010 4800010 100 500040 4800040 100");
    for (const Json& point : json["measures"][0]["points"]) {
        char query[400];
        std::snprintf(query, sizeof query, "query '%s' --nearest %.17g %.17g %.17g", (folder_ / "a.pct").c_str(),
                      point[0].get<double>(), point[1].get<double>(), point[2].get<double>());
        EXPECT_EQ(json_of(query)["neighbours"][0]["distance"], 0);
    }
    EXPECT_GT(json["largest_move"], 0);
    const double uncertainty = json["measures"][0]["values"]["distance"]["uncertainty"];
    EXPECT_GT(uncertainty, 0.001);
    EXPECT_LT(uncertainty, 2);
}

TEST_F(MeasureCommands, WhatMakesNoSenseIsRefused)
{
    expect_refused("measure", 2, "what to measure");
    expect_refused("measure length -p 1 2 3", 2, "length");
    expect_refused("measure volume -p 0 0 0 1 0 0 1 1 0", 2, "volume");
    expect_refused("measure distance -p 1 2 3 4", 2, "x y z of each point");
    expect_refused("measure distance -p 1 2 3", 1, "takes 2 or more points");
    expect_refused("measure angle -p 1 2 3 1 2 3 4 5 6", 1, "first point");
    expect_refused("measure area -p 0 0 0 4 4 0 4 0 0 0 3 0", 1, "crosses");
    expect_refused("measure distance -p 0 0 0 1 1 1 --surface 'sphere 0 0 0 1'", 2, "--surface");
    expect_refused("measure surface -p 0 0 0 --surface 'cube 1'", 1, "is not a shape");
    expect_refused("measure --list " + path("none.json"), 1, "none.json");
    std::ofstream(folder_ / "x.csv") << "precious";
    expect_refused("measure distance -p 0 0 0 1 1 1 -o " + path("x.csv"), 1, "exists already");
    EXPECT_EQ(text_in("x.csv"), "precious");
    EXPECT_EQ(pcmlab("measure distance -p 0 0 0 1 1 1 --overwrite -o " + path("x.csv")).code, 0);
    expect_refused("measure distance -p 0 0 0 1 1 1 -o " + path("x.txt"), 1, ".geojson");
    EXPECT_FALSE(fs::exists(folder_ / "x.txt"));
}

TEST_F(MeasureCommands, ProfileOfATree)
{
    make_tree("a", 1);
    const std::string line = "profile " + path("a.pct") + " --line 500000 4800030 500060 4800030 -w 2";
    const Json all = json_of(line);
    EXPECT_GT(all["points"], 300);
    EXPECT_EQ(all["length"], 60);
    EXPECT_GE(all["offsets"][0], -1);
    EXPECT_LE(all["offsets"][1], 1);
    // The same as the box, whose faces are the profile's edges.
    EXPECT_EQ(all["points"],
              json_of("query --count " + path("a.pct") + " --box 500000 4800029 0 500060 4800031 999")["points"]);
    const Json written = json_of(line + " -o " + path("p.csv") + " -a intensity");
    EXPECT_EQ(written["points"], all["points"]);
    const std::string csv = text_in("p.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), all["points"].get<int>() + 1);
    EXPECT_EQ(csv.find("station,offset,x,y,z,intensity"), 0u);
    const Json coarse = json_of(line + " --level 1");
    EXPECT_LT(coarse["points"], all["points"]);
    EXPECT_GT(coarse["spacing"], 0);
    EXPECT_LT(json_of(line + " --heights 90 93.5")["points"], all["points"]);
    EXPECT_LT(json_of(line + " --where \"z<=93.5\"")["points"], all["points"]);
    expect_refused(line + " -o " + path("p.csv"), 1, "exists already");
    expect_refused(line + " --level 99", 1, "no level 99");
    expect_refused(line + " -a none", 1, "none");
    expect_refused("profile " + path("a.pct") + " --line 1 2 1 2 -w 1", 1, "no length");
    expect_refused("profile " + path("a.pct") + " --line 1 2 3 4 5 -w 1", 2, "x y of at least 2 points");
    const Result text = pcmlab(line);
    EXPECT_NE(text.out.find("height "), std::string::npos) << text.out;
}

TEST_F(MeasureCommands, ClipsHoldInProfilesAndVolumes)
{
    make_tree("a", 1);
    const std::string tree = path("a.pct"), inside = " --clip 'box 500010 4800010 0 500040 4800050 999'",
                      hole = " --clip-outside 'sphere 500030 4800030 90 8'",
                      box = "query --count " + tree + " --box 500000 4800029 0 500060 4800031 999";
    const std::string line = "profile " + tree + " --line 500000 4800030 500060 4800030 -w 2";
    const Json clipped = json_of(line + inside + hole), all = json_of(line);
    EXPECT_EQ(clipped["points"], json_of(box + inside + hole)["points"]);
    EXPECT_GT(clipped["points"], 0);
    EXPECT_LT(json_of(line + inside)["points"], all["points"]);
    const Json volume = json_of("volume " + tree + " --side 2 --reference 90" + inside + hole);
    EXPECT_EQ(volume["points_of_tree"], json_of("query --count " + tree + inside + hole)["points"]);
    EXPECT_GT(volume["area_without_data"], json_of("volume " + tree + " --side 2 --reference 90")["area_without_data"]);
    expect_refused(line + " --clip 'ball 1 2 3 4'", 1, "ball");
}

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(MeasureCommands, PCM_NOT_UNDER_ADDRESS(VolumeOfATree))
{
    make_tree("a", 1);
    const std::string base = "volume " + path("a.pct") + " --side 2 ";
    const Json low = json_of(base + "--reference 90"), high = json_of(base + "--reference 91");
    EXPECT_EQ(low["fill"], 0);
    EXPECT_NEAR(low["net"].get<double>() - high["net"].get<double>(), high["area_counted"].get<double>(), 1e-6);
    EXPECT_GT(low["net_uncertainty"], 0);
    const Json plane = json_of(base + "--plane 500000 4800000 90 0 0 -2");
    EXPECT_NEAR(plane["net"].get<double>(), low["net"].get<double>(), 1e-6);
    ASSERT_EQ(pcmlab("transform " + path("a.pct") + " " + path("b.pct") + " --translate 0 0 1").code, 0);
    const Json raised =
        json_of("volume " + path("b.pct") + " --side 2 --before " + path("a.pct") +
                " --polygon 500010 4800010 500050 4800010 500050 4800050 500010 4800050 -o " + path("v.json"));
    EXPECT_NEAR(raised["cut"].get<double>(), raised["area_counted"].get<double>(), 1e-6);
    EXPECT_EQ(raised["fill"], 0);
    const Json list = json_of("measure --list " + path("v.json"));
    EXPECT_EQ(list["measures"][0]["values"]["net"]["value"], raised["net"]);
    EXPECT_EQ(list["measures"][0]["values"]["plan area"]["value"], 1600);
    expect_refused("volume " + path("a.pct"), 2, "--reference");
    expect_refused(base + "--reference 1 --before " + path("b.pct"), 2, "one of");
    expect_refused(base + "--plane 0 0 0 1 0 0", 1, "vertical");
    expect_refused(base + "--reference 90 --polygon 0 0 1 0 1 1", 1, "no point of");
    expect_refused("volume " + path("a.pct") + " --reference 90 --side 1e-5", 1, "take a side of");
    // The polygon is counted wholly; its headline says how much of it has points.
    EXPECT_NEAR(low["area_counted"].get<double>(), low["area"].get<double>(), 1e-6);
    EXPECT_GT(low["covered"], 0.5);
    EXPECT_LT(low["covered"], 1);
    EXPECT_EQ(low["area_interpolated"], low["area_without_data"]);
    const Result text = pcmlab(base + "--reference 90 --interpolate");
    EXPECT_NE(text.out.find(" % of the area has points, the rest is interpolated"), std::string::npos) << text.out;
    const Json measured = json_of(base + "--reference 90 --measured-only");
    EXPECT_LT(measured["area_counted"], low["area_counted"]);
    EXPECT_LT(measured["net_uncertainty"], low["net_uncertainty"]);
    EXPECT_NE(measured["notes"][0].get<std::string>().find("the volume is that of the "), std::string::npos);
    expect_refused(base + "--reference 90 --measured-only --interpolate", 2, "contradict");
    // Far narrower than the points are apart.
    const Json narrow = json_of("volume " + path("a.pct") + " --side 0.1 --reference 90");
    EXPECT_LT(narrow["covered"], 0.5);
    EXPECT_NE(narrow["notes"][0].get<std::string>().find("less than half"), std::string::npos);
    EXPECT_NEAR(narrow["net"].get<double>(), low["net"].get<double>(),
                3 * narrow["net_uncertainty"].get<double>() + 3 * low["net_uncertainty"].get<double>());
}

}  // namespace
