// pcmlab align: a cloud that was turned comes back, and what is refused.
#include "pcm/cloud/affine.h"

#include "tests/cli/command.h"

#include <cmath>

namespace {

using namespace pcm::test;
using pcm::Affine;
using pcm::Vec3d;
namespace fs = std::filesystem;

class AlignCommand : public CommandTest {
protected:
    Json json_of(const std::string& arguments)
    {
        const Result result = pcmlab(arguments + " --json");
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
    Vec3d point_near(const Vec3d& place)
    {
        std::string numbers;
        for (const double x : place) numbers += " " + std::to_string(x);
        const Json found = json_of("query " + path("site.pct") + " --nearest" + numbers);
        return found["neighbours"][0]["position"].get<Vec3d>();
    }
    std::string text_of(const Vec3d& p)
    {
        char text[100];
        std::snprintf(text, sizeof text, " %.17g %.17g %.17g", p[0], p[1], p[2]);
        return text;
    }
    // site.pct, and turned.pct, which is it moved by the inverse of `motion`.
    void make_trees()
    {
        ASSERT_EQ(pcmlab("generate -n 40000 --no-truth " + path("a.las")).code, 0);
        ASSERT_EQ(pcmlab("build " + path("a.las") + " -o " + path("site.pct") + " -m 128M").code, 0);
        ASSERT_EQ(pcmlab("transform " + path("site.pct") + " " + path("turned.pct") +
                         " --rotate 1 2 8 25 --translate 30 -20 4 --pivot 500030 4800030 100")
                      .code,
                  0);
        turned = Affine::rotation({1, 2, 8}, 25 * pcm::pi / 180, {500030, 4800030, 100});
        turned.target = {turned.target[0] + 30, turned.target[1] - 20, turned.target[2] + 4};
        for (const Vec3d& place : {Vec3d{500005, 4800005, 100}, Vec3d{500055, 4800008, 100},
                                   Vec3d{500008, 4800052, 100}, Vec3d{500030, 4800030, 115}}) {
            const Vec3d p = point_near(place);
            pairs.push_back(text_of(turned(p)) + text_of(p));
        }
    }
    Affine turned;
    std::vector<std::string> pairs;
};

TEST_F(AlignCommand, ATurnedCloudComesBack)
{
    make_trees();
    std::ofstream(folder_ / "pairs.txt") << "# moving fixed\n" << pairs[0] << "\n" << pairs[1] << "\n";
    const std::string trees = path("turned.pct") + " " + path("site.pct");
    const Json json = json_of("align " + trees + " --pairs " + path("pairs.txt") + " --pair" + pairs[2] + " --pair" +
                              pairs[3] + " -m 128M -o " + path("back.pct"));
    ASSERT_EQ(json["pairs"].size(), 4u);
    EXPECT_LT(json["rms"], 2e-8);
    EXPECT_NEAR(json["angle_degrees"].get<double>(), 25, 1e-6);
    EXPECT_LT(json["axis"][2], -0.9);
    EXPECT_EQ(json["points"], 40000);
    EXPECT_GT(json["pairs"][0]["moving_spacing"], 0);
    EXPECT_TRUE(json["notes"].empty()) << json["notes"];
    EXPECT_EQ(json["moving_crs"], json["fixed_crs"]);
    EXPECT_GT(json["error_of_cloud"], json["error_at_pairs"]);
    // matrix, pivot and target are one map
    for (std::size_t r = 0; r < 3; ++r) {
        double x = json["matrix"][r][3];
        for (std::size_t c = 0; c < 3; ++c) x += json["matrix"][r][c].get<double>() * json["pivot"][c].get<double>();
        EXPECT_NEAR(x, json["target"][r].get<double>(), 1e-8);
    }
    // The points are where they were.
    for (const Vec3d& place : {Vec3d{500003, 4800057, 100}, Vec3d{500058, 4800058, 101}, Vec3d{500031, 4800002, 99}}) {
        const Vec3d p = point_near(place);
        const Json back = json_of("query " + path("back.pct") + " --nearest" + text_of(p));
        EXPECT_LT(back["neighbours"][0]["distance"], 1e-7);
    }
}

TEST_F(AlignCommand, WithoutAnOutputOnlyTheMotionIsReported)
{
    make_trees();
    const std::string command = "align " + path("turned.pct") + " " + path("site.pct") + " --pair" + pairs[0] +
                                " --pair" + pairs[1] + " --pair" + pairs[2];
    const Result text = pcmlab(command + " --scale");
    EXPECT_EQ(text.code, 0) << text.err;
    for (const char* expected : {"pair 3: residual ", "RMS of the residuals: ", "rotation: ", "\nscale: ", "matrix: ",
                                 "uncertainty of the moved cloud: ", "nothing was written"})
        EXPECT_NE(text.out.find(expected), std::string::npos) << expected << " is missing in\n" << text.out;
    // Where the uncertainty comes from, in one line: residuals of 1e-8 do not make it small.
    const auto source = [&](const std::string& more) {
        const std::string out = pcmlab(command + more).out;
        const std::size_t at = out.find("the uncertainty follows from ");
        return at == std::string::npos ? out : out.substr(at, out.find('\n', at) - at);
    };
    const Json exact = json_of(command);
    EXPECT_LT(exact["rms"].get<double>(), 1e-6);
    EXPECT_GT(exact["pick_error"].get<double>(), 0.01);
    EXPECT_NE(source("").find("the spacing of the clouds' points, not from the residuals"), std::string::npos)
        << source("");
    EXPECT_NE(source("").find("--pick-error"), std::string::npos) << source("");
    EXPECT_EQ(source(" --pick-error 0.25"), "the uncertainty follows from --pick-error 0.25, not from the residuals");
    EXPECT_EQ(source(" --pick-error 0"), "the uncertainty follows from the residuals of the pairs");
    const Json json = json_of(command + " --pick-error 0.25");
    EXPECT_TRUE(json["output"].is_null());
    EXPECT_NEAR(json["coordinate_error"].get<double>(), 0.25 * std::sqrt(2.0), 1e-9);
    EXPECT_EQ(json["scale"], 1);
    // A point outside of the cloud is named.
    const Json beside = json_of(command + " --pair 500030 4800030 400 500030 4800030 410");
    ASSERT_EQ(beside["notes"].size(), 2u) << beside["notes"];
    EXPECT_NE(beside["notes"][0].get<std::string>().find("pair 4: the nearest point of the moving cloud is"),
              std::string::npos);
}

TEST_F(AlignCommand, WhatIsRefusedLeavesNothing)
{
    make_trees();
    const std::string trees = "align " + path("turned.pct") + " " + path("site.pct");
    const std::string out = " -o " + path("back.pct");
    EXPECT_EQ(pcmlab(trees + out).code, 2);
    EXPECT_EQ(pcmlab(trees + " --pair 1 2 3 4 5" + out).code, 2);
    const auto refused = [&](const std::string& arguments, const std::string& why) {
        const Result result = pcmlab(trees + arguments);
        EXPECT_EQ(result.code, 1) << arguments;
        EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
        EXPECT_FALSE(fs::exists(folder_ / "back.pct"));
    };
    refused(" --pair" + pairs[0] + " --pair" + pairs[1] + out, "needs three pairs of points, and there are 2");
    refused(" --pair" + pairs[0] + " --pair" + pairs[1] + " --pair" + pairs[1] + out, "in pairs 2 and 3 coincide");
    refused(" --pairs " + path("none.txt") + out, "none.txt");
    std::ofstream(folder_ / "bad.txt") << pairs[0] << "\nx\n";
    refused(" --pairs " + path("bad.txt") + out, "line 2: 'x' is not a number");
    const std::string good = " --pair" + pairs[0] + " --pair" + pairs[1] + " --pair" + pairs[2];
    refused(good + " --pick-error 40" + out, "not more than they can be picked to");
    refused(good + " --overwrite -o " + path("site.pct"), "the output is one of the two trees");
    EXPECT_EQ(pcmlab(trees + good + out).code, 0);
    const Result again = pcmlab(trees + good + out);
    EXPECT_EQ(again.code, 1);
    EXPECT_NE(again.err.find("something of this name already"), std::string::npos) << again.err;
}

}  // namespace
