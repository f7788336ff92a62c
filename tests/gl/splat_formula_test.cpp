// Each kind of splat against its formula in double precision, and how large the error of each kind is.
#include "tests/gl/splat_formulas.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace pcm;
using namespace pcm::test;

namespace {

// OpenGL's points vanish with their centres.
Splat constant_splat(const Camera& view, const Disc& disc, double side)
{
    const Eye eye = eye_of(view, disc);
    if (!(eye.window[0] >= 0 && eye.window[0] <= view.width && eye.window[1] >= 0 && eye.window[1] <= view.height))
        return [](double, double) { return infinity; };
    return square(view, disc, side);
}

// Equation 7.1 with r as a radius: 2 r n h / (|pz| (t - b)), which is 2 r times the pixels of an eye unit.
Splat dynamic_splat(const Camera& view, const Disc& disc)
{
    return square(view, disc, std::max(1.0, 2 * disc.radius * eye_of(view, disc).focal[1]));
}

// Equations 7.2 to 7.4.
Splat affine_splat(const Camera& view, const Disc& disc)
{
    const Eye eye = eye_of(view, disc);
    const ClipDepths clip = clip_of(view);
    const double r = disc.radius;
    return [=](double px, double py) {
        if (!(eye.depth > 0)) return infinity;
        const double x = (px - eye.window[0]) / eye.focal[0];
        const double y = (py - eye.window[1]) / eye.focal[1];
        const double dz = -eye.normal[0] / eye.normal[2] * x - eye.normal[1] / eye.normal[2] * y;
        const double depth = eye.depth - dz;
        return x * x + y * y + dz * dz <= r * r && depth > clip.near && depth < clip.far ? depth : infinity;
    };
}

std::vector<Splat> splats_of(SplatMode mode, const Camera& view, const std::vector<Disc>& discs, double point_size)
{
    std::vector<Splat> splats;
    for (const Disc& disc : discs)
        splats.push_back(mode == SplatMode::constant   ? constant_splat(view, disc, point_size)
                         : mode == SplatMode::adaptive ? dynamic_splat(view, disc)
                                                       : affine_splat(view, disc));
    return splats;
}

}  // namespace

// Not under the address sanitizer: much drawing in software.
TEST(SplatFormula, PCM_NOT_UNDER_ADDRESS(EachAgreesWithItsFormula))
{
    for (const Profile profile : {Profile::core, Profile::compatibility}) {
        PCM_REQUIRE_GL(context, profile);
        const SplatScene scene(fine_grid(), field(80, 1));
        for (const Camera& view : {perspective_view(), parallel_view()})
            for (const SplatMode mode : {SplatMode::constant, SplatMode::adaptive, SplatMode::affine})
                for (const bool reversed : {true, false}) {
                    if (!reversed && view.projection[11] != 0)
                        continue;  // floats near 1 resolve less; splat_disc_test.cpp tests that
                    SCOPED_TRACE(testing::Message()
                                 << name_of(mode) << (view.projection[11] == 0 ? ", parallel" : ", perspective"));
                    CloudStyle style = style_of(mode);
                    style.point_size_px = 5;
                    const auto truth = picture_of(view, splats_of(mode, view, scene.discs(view), 5), 0.02);
                    expect_same(draw(scene, view, style, reversed), truth, view, reversed, 500);
                }
    }
}

TEST(SplatFormula, DynamicSquaresOfAnySizeAtTheBorder)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // Many centres are outside; then squares that are larger than the driver's points.
    for (const double size : {0.5, 8.0}) {
        const SplatScene scene(fine_grid(), field(60, 2, 1.5, size));
        for (const Camera& view : {perspective_view(), parallel_view()}) {
            const auto truth = picture_of(view, splats_of(SplatMode::adaptive, view, scene.discs(view), 0), 0.02);
            expect_same(draw(scene, view, style_of(SplatMode::adaptive)), truth, view, true, 500);
        }
    }
    // No point vanishes: with a radius of 0, or far away, it covers one pixel. (A square of 1 pixel covers exactly one
    // centre.)
    std::vector<Disc> tiny;
    for (int d = 0; d < 50; ++d) tiny.push_back({{-4 + 0.16 * d, 0.013 * d, -9}, {0, 0, 1}, d % 2 ? 0.0 : 1e-9});
    const SplatScene scene(fine_grid(), tiny);
    const Drawn picture = draw(scene, perspective_view(), style_of(SplatMode::adaptive));
    EXPECT_EQ(std::count_if(picture.colours.begin(), picture.colours.end(), [](const Pixel& p) { return p.a == 255; }),
              50);  // the mark of the smallest splats
}

TEST(SplatFormula, ErrorsAreOrdered)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // Tilted discs all over a wide view.
    const Camera view = view_of(identity(), perspective(1.4, aspect, 0.1, 100), width, height);
    const SplatScene scene(fine_grid(), field(40, 3));
    const auto truth = DiscOracle(view).picture(scene.discs(view));
    const auto wrong = [&](SplatMode mode) {
        const Drawn picture = draw(scene, view, style_of(mode));
        std::size_t pixels = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) pixels += (picture.colours[i].a != 0) != (truth[i].disc >= 0);
        return pixels;
    };
    const std::size_t perspective_errors = wrong(SplatMode::perspective);
    const std::size_t affine_errors = wrong(SplatMode::affine);
    const std::size_t dynamic_errors = wrong(SplatMode::adaptive);
    EXPECT_LE(perspective_errors, 2u);
    EXPECT_LT(5 * perspective_errors, affine_errors);
    EXPECT_LT(5 * affine_errors, 4 * dynamic_errors);
}

TEST(SplatFormula, AFixedPointStaysUnderASlowPanAtMapCoordinates)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // A chunk of two kilometres; the eye is half a metre from what it looks at and turns by a twentieth of a pixel a
    // frame. Every edge is within 0.025 px of where it should be in each frame, so between two it moves by what it
    // should to 0.05 px.
    const Vec3d eye{5e6 + 987.6543, 4.8e6 + 1234.5678, 321.0987};
    std::vector<Disc> discs = field(12, 5, 0.5);
    for (Disc& disc : discs) {
        for (std::size_t a = 0; a < 3; ++a) disc.centre[a] = 0.1 * disc.centre[a] + eye[a];
        disc.radius *= 0.1;
    }
    discs.push_back({{5e6, 4.8e6, 0}, {0, 0, 1}, 0.01});
    discs.push_back({{5e6 + 2000, 4.8e6 + 2000, 500}, {0, 0, 1}, 0.01});
    const SplatScene scene({{1e-4, 1e-4, 1e-4}, {5e6, 4.8e6, 0}}, discs);
    const Vec3d origin{5e6 + 1000, 4.8e6 + 1000, 0};
    const int side = 64;
    const Matrix projection = perspective(0.6, 1, 1e-3, 1e3);
    const double pixel = 2 * std::tan(0.3) / side;
    for (int frame = 0; frame < 24; ++frame) {
        const Matrix turn = rotation_x(0.05 * pixel * frame);
        const Camera view =
            view_of(product(turn, translation(origin[0] - eye[0], origin[1] - eye[1], origin[2] - eye[2])), projection,
                    side, side, origin);
        for (const SplatMode mode :
             {SplatMode::constant, SplatMode::adaptive, SplatMode::affine, SplatMode::perspective}) {
            SCOPED_TRACE(testing::Message() << name_of(mode) << ", frame " << frame);
            CloudStyle style = style_of(mode);
            style.point_size_px = 7;
            const std::vector<Disc> known = scene.discs(view);
            const auto truth = mode == SplatMode::perspective
                                   ? DiscOracle(view).picture(known, 0.025)
                                   : picture_of(view, splats_of(mode, view, known, 7), 0.025);
            expect_same(draw(scene, view, style), truth, view, true, 100);
        }
    }
}

// Not under the address sanitizer: much drawing in software.
TEST(SplatFormula, PCM_NOT_UNDER_ADDRESS(DiscsAreAntialiasedSampleBySample))
{
    for (const Profile profile : {Profile::core, Profile::compatibility}) {
        PCM_REQUIRE_GL(context, profile);
        constexpr unsigned samples = 4;
        const DepthFramebuffer framebuffer(width, height, samples);
        std::array<std::array<float, 2>, samples> places{};
        for (unsigned s = 0; s < samples; ++s) glGetMultisamplefv(GL_SAMPLE_POSITION, s, places[s].data());
        for (const Camera& view : {perspective_view(), parallel_view()})
            for (const SplatMode mode : {SplatMode::affine, SplatMode::perspective, SplatMode::adaptive}) {
                SCOPED_TRACE(testing::Message()
                             << name_of(mode) << (view.projection[11] == 0 ? ", parallel" : ", perspective"));
                const SplatScene scene(fine_grid(), field(12, 6));
                framebuffer.clear(true);
                SplatPass pass;
                scene.draw(pass, view, style_of(mode), true, samples);
                const auto pixels = framebuffer.colours();
                pass.release();
                const auto discs = scene.discs(view);
                const auto splats = splats_of(mode, view, discs, 0);
                const DiscOracle oracle(view);
                std::size_t wrong = 0, partly = 0;
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        int covered = 0;
                        bool certain = true;
                        for (const auto& place : places) {
                            const double sx = x + static_cast<double>(place[0]);
                            const double sy = y + static_cast<double>(place[1]);
                            if (mode == SplatMode::perspective) {
                                const DiscHit hit = oracle.cast(discs, sx, sy, 0.02);
                                covered += hit.disc >= 0;
                                certain = certain && hit.certain;
                            } else {
                                const auto any = [&](double dx, double dy) {
                                    return std::any_of(splats.begin(), splats.end(), [&](const Splat& splat) {
                                        return splat(sx + dx, sy + dy) < infinity;
                                    });
                                };
                                covered += any(0, 0);
                                for (int k = 0; k < 9; ++k)
                                    certain = certain && any(0.02 * (k % 3 - 1), 0.02 * (k / 3 - 1)) == any(0, 0);
                            }
                        }
                        if (!certain) continue;
                        partly += covered > 0 && covered < 4;
                        const int alpha = pixels[static_cast<std::size_t>(y * width + x)].a;
                        // A covered sample has 240 to 255, as its splat is large or small.
                        wrong += alpha < 240 * covered / 4 - 1 || alpha > 255 * covered / 4 + 1;
                    }
                EXPECT_EQ(wrong, 0u);
                EXPECT_GT(partly, 100u);
            }
    }
}
