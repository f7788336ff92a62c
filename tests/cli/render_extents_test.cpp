// pcmlab render of clouds of any extent: the picture is the one of a metre's cloud, or it is refused, and never empty
// without a word.

#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#ifdef PCM_HAVE_RENDER

#include <cmath>
#include <random>

namespace {

using namespace pcm::test;

class RenderExtents : public CommandTest {
protected:
    // A wave, `extent` wide.
    void build(double extent)
    {
        {
            std::ofstream file(folder_ / "cloud.xyz");
            std::mt19937_64 random(3);
            file.precision(17);
            for (int i = 0; i < 2000; ++i) {
                const double x = static_cast<double>(random() >> 44) * 0x1p-20,
                             y = static_cast<double>(random() >> 44) * 0x1p-20,
                             z = 0.1 * std::sin(6 * x) * std::cos(5 * y);
                file << x * extent << ' ' << y * extent << ' ' << std::round(z * 0x1p20) * 0x1p-20 * extent << '\n';
            }
        }
        const Result built = pcmlab("build --overwrite " + path("cloud.xyz") + " -o " + path("cloud.pct"));
        ASSERT_EQ(built.code, 0) << built.err;
    }
    Result render(const std::string& arguments)
    {
        return pcmlab("render --json --overwrite --size 160x100 " + path("cloud.pct") + " -o " + path("cloud.png") +
                      " " + arguments);
    }
};

// Not under the address sanitizer: much drawing in software.
TEST_F(RenderExtents, PCM_NOT_UNDER_ADDRESS(AreDrawnRightOrRefused))
{
    const char* const views[] = {"", "--orthographic", "--angle 5", "--angle 60 --eye-dome 1",
                                 "--splats constant --angle 150"};
    std::map<std::string, double> pixels;
    build(1);
    const Result tried = render("");
    PCM_REQUIRE_DRAWING(tried);
    for (const char* view : views) {
        const Result drawn = render(view);
        ASSERT_EQ(drawn.code, 0) << drawn.err;
        pixels[view] = Json::parse(drawn.out)["pictures"][0]["pixels"];
        ASSERT_GT(pixels[view], 100);
    }
    int refused = 0;
    for (const int power : {-45, -38, -33, -30, -20, 10, 20, 29, 31, 34, 36, 37, 38, 60, 140}) {
        build(std::pow(10, power));
        for (const char* view : views) {
            const std::string when = "1e" + std::to_string(power) + " " + view;
            const Result drawn = render(view);
            if (drawn.code != 0) {
                ++refused;
                EXPECT_NE(drawn.err.find("single precision"), std::string::npos) << when << ": " << drawn.err;
                EXPECT_NE(drawn.err.find("pcmlab transform --scale"), std::string::npos) << when << ": " << drawn.err;
                EXPECT_TRUE(power < -29 || power > 28) << when;
                continue;
            }
            const double found = Json::parse(drawn.out)["pictures"][0]["pixels"];
            EXPECT_NEAR(found, pixels[view], 0.05 * pixels[view]) << when;
        }
    }
    EXPECT_GT(refused, 0);
}

// From very far, and through a very narrow angle.
TEST_F(RenderExtents, PCM_NOT_UNDER_ADDRESS(ViewsThatReachTooFarAreRefused))
{
    build(1);
    const Result tried = render("");
    PCM_REQUIRE_DRAWING(tried);
    const Result far = render("--eye 1e40 0 0");
    EXPECT_EQ(far.code, 1) << far.out;
    EXPECT_NE(far.err.find("the view reaches"), std::string::npos) << far.err;
}

}  // namespace

#endif
