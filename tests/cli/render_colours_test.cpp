// What pcmlab render colours and shows: attributes, ramps, ranges, conditions.

#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#ifdef PCM_HAVE_RENDER

#include "pcm/offscreen/image.h"

#include <algorithm>
#include <set>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class RenderColours : public CommandTest {
protected:
    void SetUp() override
    {
        std::vector<LasRecord> points = records(Shape::surface, 8000, 4);
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i].intensity = static_cast<std::uint16_t>(i % 100 + 200);
            points[i].classification = static_cast<std::uint8_t>(i % 4 + 1);
        }
        points[11].intensity = 65535;
        write_las(folder_ / "in.las", points, {{0.01, 0.01, 0.01}, {500000, 4800000, 0}});
        ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
        const Result tried = pcmlab("render " + path("in.pct") + " -o " + path("tried.png") + " --size 16x16");
        PCM_REQUIRE_DRAWING(tried);
        ASSERT_EQ(tried.code, 0) << tried.err;
    }
    // What is reported about the only cloud in a picture.
    Json drawn(const std::string& options)
    {
        const Result result = pcmlab("render --json --overwrite --size 640x360 " + path("in.pct") + " -o " +
                                     path("a.png") + " " + options);
        EXPECT_EQ(result.code, 0) << options << ": " << result.err;
        return result.code == 0 ? Json::parse(result.out)["pictures"][0]["clouds"][0] : Json();
    }
    void expect_refusal(const std::string& options, const std::string& part)
    {
        const Result result = pcmlab("render " + path("in.pct") + " -o " + path("b.png") + " " + options);
        EXPECT_NE(result.code, 0) << options;
        EXPECT_NE(result.err.find(part), std::string::npos) << options << ": " << result.err;
        EXPECT_FALSE(fs::exists(folder_ / "b.png"));
    }
};

TEST_F(RenderColours, AnAttributeIsNamedAndItsRangeReported)
{
    Json cloud = drawn("--colour intensity");
    EXPECT_EQ(cloud["colour"], "intensity");
    EXPECT_EQ(cloud["ramp"], "grey");
    EXPECT_GE(cloud["range"][0], 200);
    EXPECT_LE(cloud["range"][1], 299);  // not the outlier
    EXPECT_GT(cloud["range"][1], 290);
    cloud = drawn("--colour return_number --ramp turbo");
    EXPECT_EQ(cloud["colour"], "attribute");
    EXPECT_EQ(cloud["attribute"], "return_number");
    EXPECT_EQ(cloud["ramp"], "turbo");
    cloud = drawn("--colour height --range -5:1000");
    EXPECT_EQ(cloud["range"], Json::parse("[-5.0, 1000.0]"));
    const pcm::Image flat = pcm::read_png(folder_ / "a.png");
    drawn("--colour height");
    EXPECT_FALSE(pcm::read_png(folder_ / "a.png") == flat);
    expect_refusal("--colour pink", "an attribute: intensity");
    expect_refusal("--colour rgb --range 1:2", "--colour height");
    expect_refusal("--colour height --range 2:1", "'2:1'");
    expect_refusal("--colour height --ramp pink", "pink");
}

// Pictures are drawn under the address sanitizer by the tests of the rooms that draw; here it takes minutes.
TEST_F(RenderColours, PCM_NOT_UNDER_ADDRESS(TheLegendIsInTheCorner))
{
    const auto drawn_as = [&](const std::string& options) {
        drawn(options);
        return pcm::read_png(folder_ / "a.png");
    };
    for (const std::string background : {"transparent", "white"}) {
        const std::string options = "--colour height --background " + background;
        const pcm::Image without = drawn_as(options), with = drawn_as(options + " --legend");
        std::set<std::array<std::uint8_t, 3>> colours;
        for (int y = 0; y < 360; ++y)
            for (int x = 0; x < 640; ++x) {
                const std::uint8_t *a = without.pixel(x, y), *b = with.pixel(x, y);
                const bool same = std::equal(a, a + 4, b);
                EXPECT_TRUE(same || (x > 440 && y < 140)) << x << ' ' << y;
                if (!same) colours.insert({b[0], b[1], b[2]});
            }
        EXPECT_GT(colours.size(), 80u);  // the bar
        EXPECT_TRUE(colours.count({68, 1, 84})) << "the ramp's beginning";
    }
    EXPECT_TRUE(drawn_as("--uniform-colour 9,9,9 --legend") == drawn_as("--uniform-colour 9,9,9"));
}

TEST_F(RenderColours, PCM_NOT_UNDER_ADDRESS(ConditionsChooseWhatIsShown))
{
    const Json cloud = drawn("--colour classification --where classification=2,4 --where 'intensity<250'");
    EXPECT_EQ(cloud["points_drawn"], 1999);  // without the bright one
    EXPECT_EQ(cloud["points_hidden"], 6001);
    EXPECT_EQ(cloud["classes"], Json::parse("[2, 4]"));
    const std::string command = "render --overwrite --size 160x120 " + path("in.pct") + " -o " + path("a.png");
    const Result some = pcmlab(command + " --where classification=2");
    EXPECT_NE(some.out.find("2,000 points, every point in view that satisfies the conditions"), std::string::npos)
        << some.out;
    EXPECT_NE(some.out.find("note: 6,000 points do not"), std::string::npos) << some.out;
    const Result none = pcmlab(command + " --where classification=9");
    EXPECT_EQ(none.code, 0) << none.err;
    EXPECT_NE(none.out.find("no point in view satisfies the conditions"), std::string::npos) << none.out;
    expect_refusal("--where classification", "classification");
    expect_refusal("--where none=1", "none");
}

}  // namespace

#endif
