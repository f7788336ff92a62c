// pcmlab pick.

#include "tests/cli/command.h"

#include <cmath>

namespace {

using namespace pcm::test;

class Pick : public CommandTest {
protected:
    // A lattice of 1 unit at map coordinates, 100 x 100, and one point 30 units above its middle.
    void SetUp() override
    {
        std::vector<LasRecord> points;
        for (int i = 0; i < 100; ++i)
            for (int j = 0; j < 100; ++j) {
                LasRecord p{};
                p.x = 1000 * i + 1, p.y = 1000 * j, p.z = 0;
                p.intensity = static_cast<std::uint16_t>(100 * i + j);
                p.classification = 2;
                points.push_back(p);
            }
        LasRecord above{};
        above.x = 50001, above.y = 50000, above.z = 30000;
        above.intensity = 60000;
        above.classification = 6;
        points.push_back(above);
        write_las(folder_ / "in.las", points, {{0.001, 0.001, 0.001}, {5e6, 4.8e6, 0}});
        ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
    }
    Json run(const std::string& arguments)
    {
        const Result result = pcmlab("pick --json " + path("in.pct") + " " + arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
    std::string refusal(const std::string& arguments)
    {
        const Result result = pcmlab("pick " + path("in.pct") + " " + arguments);
        EXPECT_EQ(result.code, 1);
        return result.err;
    }
};

const std::string down = "--ray 5000050.001 4800050 100 0 0 -1 --pixel-size 0.01";

TEST_F(Pick, GivesTheFirstPointOfARayWithEveryDigit)
{
    const Json point = run(down)["point"];
    EXPECT_EQ(point["position"], Json({5000050.001, 4800050.0, 30.0}));
    EXPECT_EQ(point["attributes"]["intensity"], 60000);
    EXPECT_EQ(point["attributes"]["classification"], 6);
    EXPECT_EQ(point["along"], 70.0);
    EXPECT_EQ(point["grid_step"], 0.001);
    EXPECT_GT(point["spacing"], 0);
    const Result text = pcmlab("pick " + path("in.pct") + " " + down);
    EXPECT_NE(text.out.find("5000050.001 4800050 30\n"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("60000"), std::string::npos) << text.out;
}

TEST_F(Pick, SeesOnlyWhatConditionsAndClipsLeave)
{
    EXPECT_EQ(run(down + " --where classification=2")["point"]["attributes"]["intensity"], 5050);
    EXPECT_EQ(run(down + " --clip 'box 5000000 4800000 -1 5000100 4800100 1'")["point"]["attributes"]["intensity"],
              5050);
    EXPECT_EQ(run(down + " --clip-outside 'sphere 5000050 4800050 30 2'")["point"]["attributes"]["intensity"], 5050);
    EXPECT_TRUE(run(down + " --clip 'sphere 0 0 0 1'")["point"].is_null());
}

// The pixel that a camera sees a point at gives that point, in both projections.
TEST_F(Pick, GivesThePointAtAPixelOfAView)
{
    for (const std::string kind : {"--angle 40", "--height 50"}) {
        const std::string camera =
            "--eye 5000020.001 4800030 200 --target 5000020.001 4800030 0 --up 0 1 0 --size 801x601 " + kind;
        EXPECT_EQ(run(camera + " --at 400.5 300.5")["point"]["attributes"]["intensity"], 2030) << kind;
        const double pixel = kind == "--height 50" ? 50.0 / 601 : 2 * 200 * std::tan(20 * M_PI / 180) / 601;
        const auto at = [&](double x, double y) {
            return " --at " + std::to_string(400.5 + x / pixel) + " " + std::to_string(300.5 - y / pixel);
        };
        EXPECT_EQ(run(camera + at(7, 0))["point"]["attributes"]["intensity"], 2730) << kind;
        EXPECT_EQ(run(camera + at(0, 4))["point"]["attributes"]["intensity"], 2034) << kind;
        EXPECT_TRUE(run(camera + " --tolerance 2 --radius-scale 0" + at(0.5, 0.5))["point"].is_null()) << kind;
        EXPECT_FALSE(run(camera + " --tolerance 2" + at(0.5, 0.5))["point"].is_null()) << "splats close the surface";
    }
}

TEST_F(Pick, SaysWhatIsMissingOrTooMuch)
{
    EXPECT_NE(refusal("").find("neither --ray nor --at"), std::string::npos);
    EXPECT_NE(refusal(down + " --at 1 1").find("--ray and a camera or --at"), std::string::npos);
    EXPECT_NE(refusal("--at 1 1 --pixel-size 1").find("belong to --ray"), std::string::npos);
    EXPECT_NE(refusal("--at 1 1 --size 3").find("--size '3' is not a size"), std::string::npos);
    EXPECT_NE(refusal("--ray 1 2 3 0 0 0").find("direction"), std::string::npos);
    EXPECT_NE(refusal(down + " --tolerance 0").find("above 0"), std::string::npos);
    EXPECT_NE(refusal(down + " --where nothing=1").find("no attribute 'nothing'"), std::string::npos);
    const Result nothing = pcmlab("pick " + path("in.pct") + " --ray 0 0 100 0 0 -1");
    EXPECT_EQ(nothing.code, 0);
    EXPECT_NE(nothing.out.find("no point there"), std::string::npos) << nothing.out;
}

}  // namespace
