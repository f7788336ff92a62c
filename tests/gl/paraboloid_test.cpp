// Adaptive splats of resting views: paraboloids, against their formula.
#include "tests/gl/splat_formulas.h"
#include "tests/sanitizers.h"

#include <random>
#include <utility>

using namespace pcm;
using namespace pcm::test;

namespace {

// A disc around the centre, 1.25 times as large as the square that it replaces, whose depth grows by half a radius
// towards its rim. Below three pixels it fills its square.
Splat paraboloid(const Camera& view, const Disc& disc)
{
    const Eye eye = eye_of(view, disc);
    const ClipDepths clip = clip_of(view);
    const double side = std::max(1.0, 2 * 1.25 * disc.radius * eye.focal[1]);
    const double radius = side / 2 / eye.focal[1];
    return [=](double x, double y) {
        const double dx = (x - eye.window[0]) / (side / 2), dy = (y - eye.window[1]) / (side / 2);
        const double q = dx * dx + dy * dy;
        const bool inside = side <= 3 ? std::max(std::abs(dx), std::abs(dy)) <= 1 : q <= 1;
        if (!inside || !(eye.depth > clip.near && eye.depth < clip.far)) return infinity;
        return eye.depth + 0.5 * radius * q;
    };
}

std::vector<Splat> paraboloids(const Camera& view, const std::vector<Disc>& discs)
{
    std::vector<Splat> splats;
    for (const Disc& disc : discs) splats.push_back(paraboloid(view, disc));
    return splats;
}

Drawn at_rest(const SplatScene& scene, const Camera& view, bool reversed = true)
{
    return draw(scene, view, style_of(SplatMode::adaptive), reversed, {}, true);
}

std::size_t count_covered(const Drawn& picture)
{
    return static_cast<std::size_t>(
        std::count_if(picture.colours.begin(), picture.colours.end(), [](const Pixel& p) { return p.a != 0; }));
}

}  // namespace

// Not under the address sanitizer: much drawing in software.
TEST(Paraboloid, PCM_NOT_UNDER_ADDRESS(AgreesWithItsFormula))
{
    for (const Profile profile : {Profile::core, Profile::compatibility}) {
        PCM_REQUIRE_GL(context, profile);
        // Pixels and a few, usual ones, and some larger than the driver's points, which are drawn as quads.
        for (const double size : {0.04, 1.0, 12.0}) {
            const SplatScene scene(fine_grid(), field(size < 1 ? 600 : 80, 1, size > 1 ? 1.5 : 0.8, size));
            for (const Camera& view : {perspective_view(), parallel_view()})
                for (const bool reversed : {true, false}) {
                    const bool parallel = view.projection[11] == 0;
                    if (!reversed && !parallel) continue;  // floats near 1 resolve less
                    SCOPED_TRACE(testing::Message() << "size " << size << (parallel ? ", parallel" : ", perspective")
                                                    << (reversed ? ", reversed" : ""));
                    const auto truth = picture_of(view, paraboloids(view, scene.discs(view)), 0.02);
                    expect_same(at_rest(scene, view, reversed), truth, view, reversed, size < 1 ? 300 : 500);
                }
        }
    }
}

// Among equal splats in a plane that faces the view, the one whose centre is nearest is seen: no square covers another.
TEST(Paraboloid, TheNearestCentreIsSeen)
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> even(-1, 1);
    std::vector<Disc> discs;
    for (int d = 0; d < 60; ++d) discs.push_back({{4 * even(random), 3 * even(random), -9}, {0, 0, 1}, 2});
    const SplatScene scene(fine_grid(), discs);
    const Camera view = parallel_view();
    std::vector<Eye> eyes;
    for (const Disc& disc : scene.discs(view)) eyes.push_back(eye_of(view, disc));
    const auto wrong = [&](const Drawn& picture) {
        std::size_t count = 0, covered = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const Pixel& pixel = picture.colours[static_cast<std::size_t>(y * width + x)];
                if (pixel.a == 0) continue;
                ++covered;
                const auto away = [&](const Eye& e) {
                    return std::hypot(x + 0.5 - e.window[0], y + 0.5 - e.window[1]);
                };
                double least = infinity;
                for (const Eye& e : eyes) least = std::min(least, away(e));
                count += away(eyes[static_cast<std::size_t>(SplatScene::disc_of(pixel))]) > least + 0.05;
            }
        EXPECT_GT(covered, 10000u);
        return count;
    };
    EXPECT_EQ(wrong(at_rest(scene, view)), 0u);
    EXPECT_GT(wrong(draw(scene, view, style_of(SplatMode::adaptive))), 5000u);
}

// A splat of less than three pixels would lose the corners of its square, and with them pixels of a surface.
TEST(Paraboloid, SmallOnesFillTheirSquares)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const Camera view = parallel_view();  // 16 pixels a unit
    for (const auto& [side, pixels] : {std::pair{1.2, 1u}, {2.7, 9u}, {4.9, 21u}, {6.9, 37u}}) {
        // Centres at centres of pixels.
        std::vector<Disc> discs;
        for (int d = 0; d < 12; ++d)
            discs.push_back({{(20.5 + 30 * (d % 4) - 80) / 16 - 0.3, (20.5 + 30 * (d / 4) - 60) / 16, -9},
                             {0, 0, 1},
                             side / 32 / 1.25});
        EXPECT_EQ(count_covered(at_rest(SplatScene(fine_grid(), discs), view)), 12 * pixels) << side;
    }
}

// A flat cloud just before the far plane is drawn whole, though its splats reach beyond it.
TEST(Paraboloid, BeforeTheFarPlaneNothingIsCutOff)
{
    for (const Profile profile : {Profile::core, Profile::compatibility}) {
        PCM_REQUIRE_GL(context, profile);
        for (const double size : {0.5, 12.0}) {
            const SplatScene scene(fine_grid(), {{{-1, 0.2, -9}, {0, 0, 1}, size}, {{1, 0, -9}, {0, 0, 1}, size}});
            for (const bool reversed : {true, false})
                for (const bool parallel : {true, false}) {
                    const auto view = [&](double far) {
                        return view_of(
                            identity(),
                            parallel ? orthographic(5, 5 / aspect, 0.1, far) : perspective(1, aspect, 1, far), width,
                            height);
                    };
                    const std::size_t whole = count_covered(at_rest(scene, view(100), reversed));
                    EXPECT_GT(whole, 300u);
                    EXPECT_EQ(count_covered(at_rest(scene, view(9.001), reversed)), whole)
                        << size << (reversed ? ", reversed" : "") << (parallel ? ", parallel" : ", perspective");
                    EXPECT_EQ(count_covered(at_rest(scene, view(8.99), reversed)), 0u);
                }
        }
    }
}

// With several samples a pixel well inside of a disc is covered whole, and one well outside of all is not.
TEST(Paraboloid, OfSeveralSamples)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const DepthFramebuffer framebuffer(width, height, 4);
    for (const Camera& view : {perspective_view(), parallel_view()}) {
        const SplatScene scene(fine_grid(), field(12, 6));
        framebuffer.clear(true);
        SplatPass pass;
        scene.draw(pass, view, style_of(SplatMode::adaptive), true, 4, {}, true);
        const auto pixels = framebuffer.colours();
        pass.release();
        const auto splats = paraboloids(view, scene.discs(view));
        std::size_t wrong = 0, inside = 0, outside = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                bool within = false, without = true;
                for (const Splat& splat : splats) {
                    std::size_t hits = 0;
                    for (int k = 0; k < 9; ++k)
                        hits += splat(x + 0.5 + 0.75 * (k % 3 - 1), y + 0.5 + 0.75 * (k / 3 - 1)) < infinity;
                    within = within || hits == 9;
                    without = without && hits == 0;
                }
                const int alpha = pixels[static_cast<std::size_t>(y * width + x)].a;
                inside += within;
                outside += without;
                wrong += (within && alpha < 240) || (without && alpha != 0);
            }
        EXPECT_EQ(wrong, 0u);
        EXPECT_GT(inside, 500u);
        EXPECT_GT(outside, 500u);
    }
}

// Discs and pixels are what they are in any view.
TEST(Paraboloid, OnlyAdaptiveSplatsAreDrawnSo)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const SplatScene scene(fine_grid(), field(60, 9));
    for (const SplatMode mode : {SplatMode::constant, SplatMode::affine, SplatMode::perspective, SplatMode::adaptive}) {
        const Drawn moving = draw(scene, perspective_view(), style_of(mode));
        const Drawn resting = draw(scene, perspective_view(), style_of(mode), true, {}, true);
        EXPECT_EQ(moving.colours == resting.colours, mode != SplatMode::adaptive) << name_of(mode);
    }
}
