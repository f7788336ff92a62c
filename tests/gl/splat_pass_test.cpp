// What all kinds of splats have in common: repeatability, missing attributes, least sizes, colours, OpenGL's state.
#include "tests/gl/splat_scene.h"

#include "pcm/cloud/vector.h"
#include "pcm/gl/base/gl_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace pcm;
using namespace pcm::test;

TEST(SplatPass, TwoFramesAreTheSameBitForBit)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const SplatScene scene(fine_grid(), field(80, 4));
    for (const SplatTraits& traits : splat_modes()) {
        const SplatMode mode = traits.mode;
        const Drawn one = draw(scene, perspective_view(), style_of(mode));
        const Drawn two = draw(scene, perspective_view(), style_of(mode));
        EXPECT_TRUE(one.colours == two.colours && one.depths == two.depths) << name_of(mode);
    }
}

TEST(SplatPass, MissingAttributesAreReplaced)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const Camera view = perspective_view();
    const auto discs = field(40, 7);
    const SplatScene all(fine_grid(), discs);
    const SplatScene no_normals(fine_grid(), discs, {ColourSource::rgb, true, false});
    const SplatScene bare(fine_grid(), discs, {ColourSource::rgb, false, false});
    const SplatScene no_colours(fine_grid(), discs, {ColourSource::none, true, true});
    const auto same = [](const Drawn& a, const Drawn& b) { return a.colours == b.colours && a.depths == b.depths; };
    EXPECT_TRUE(
        same(draw(no_normals, view, style_of(SplatMode::perspective)), draw(all, view, style_of(SplatMode::adaptive))));
    EXPECT_TRUE(same(draw(bare, view, style_of(SplatMode::affine)), draw(all, view, style_of(SplatMode::constant))));
    EXPECT_TRUE(same(draw(bare, view, style_of(SplatMode::adaptive)), draw(all, view, style_of(SplatMode::constant))));
    const Drawn uncoloured = draw(no_colours, view, style_of(SplatMode::perspective));
    const Drawn coloured = draw(all, view, style_of(SplatMode::perspective));
    EXPECT_EQ(uncoloured.depths, coloured.depths);
    for (const Pixel& p : uncoloured.colours) EXPECT_TRUE(p.a == 0 || (p.r == 191 && p.g == 191 && p.b == 191));

    // A normal of zero faces the eye; a radius of zero or NaN draws nothing.
    std::vector<Disc> odd{{{0, 0, -5}, {0, 0, 0}, 1},
                          {{1.5, 1, -5}, {std::nan(""), 0, 1}, 0.5},
                          {{-1.5, 1, -5}, {0, 0, 1}, std::nan("")},
                          {{-1, -1, -5}, {0, 0, 1}, -2}};
    const SplatScene scene(fine_grid(), odd);
    odd.resize(2);
    for (Disc& disc : odd) disc.normal = disc.centre;
    const SplatScene facing(fine_grid(), odd);
    const Drawn a = draw(scene, view, style_of(SplatMode::perspective));
    const Drawn b = draw(facing, view, style_of(SplatMode::perspective));
    std::size_t different = 0, covered = 0;
    for (std::size_t i = 0; i < a.colours.size(); ++i) {
        different += !(a.colours[i] == b.colours[i]);
        covered += b.colours[i].a != 0;
    }
    EXPECT_LE(different, 4u);  // at silhouettes
    EXPECT_GT(covered, 500u);
    // The minimum size applies to such points too.
    ChunkLook look;
    look.least_radius = 0.25f;
    look.least_px = 100;
    const Drawn c = draw(scene, view, style_of(SplatMode::perspective), true, look);
    for (int d = 0; d < 4; ++d)
        EXPECT_TRUE(std::any_of(c.colours.begin(), c.colours.end(), [&](const Pixel& p) {
            return SplatScene::disc_of(p) == d;
        })) << d;
}

TEST(SplatPass, GapsAreFilled)
{
    PCM_REQUIRE_GL(context, Profile::core);
    for (const Camera& view : {perspective_view(), parallel_view()})
        for (const SplatMode mode :
             {SplatMode::constant, SplatMode::adaptive, SplatMode::affine, SplatMode::perspective})
            for (const double depth : {3.0, 9.0}) {
                // Facing the view, so that discs are as large as squares.
                const SplatScene scene(fine_grid(), {{{-0.4 * depth, 0, -depth}, {0, 0, 1}, 1e-4},
                                                     {{0.3 * depth, 0.2 * depth, -depth}, {0, 0, 1}, 1e-4}});
                const auto covered = [&](const SplatScene& of, float least_px, float least_radius = 1e6f) {
                    ChunkLook look;
                    look.least_radius = least_radius;
                    look.least_px = least_px;
                    std::size_t count = 0;
                    for (const Pixel& p : draw(of, view, style_of(mode), true, look).colours) count += p.a != 0;
                    return static_cast<double>(count);
                };
                for (const float size : {6.0f, 13.0f, 20.0f}) {
                    const bool square = mode == SplatMode::constant || mode == SplatMode::adaptive;
                    const double one = static_cast<double>(size * size) * (square ? 1 : pi / 4);
                    EXPECT_NEAR(covered(scene, size), 2 * one, 0.12 * 2 * one + 4)
                        << name_of(mode) << " at " << depth << ", " << size << " px";
                }
                // The other bound: a length.
                const double focal = view.projection[5] * height / 2 / (view.projection[15] == 0 ? depth : 1);
                const double side = 2 * 0.15 * focal;
                const bool round = mode == SplatMode::affine || mode == SplatMode::perspective;
                EXPECT_NEAR(covered(scene, 1000, 0.15f), 2 * side * side * (round ? pi / 4 : 1),
                            0.12 * 2 * side * side + 4)
                    << name_of(mode) << " at " << depth;
                if (mode == SplatMode::constant) continue;
                const SplatScene large(fine_grid(), {{{0, 0, -depth}, {0, 0, 1}, 0.4}});
                EXPECT_EQ(covered(large, 6), covered(large, 0)) << name_of(mode);
            }
}

TEST(SplatPass, ColoursByLevelErrorHeightAndOneForAll)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const Camera view = perspective_view();
    const SplatScene scene(
        fine_grid(), {{{0, -2, -6}, {0, 0, 1}, 0.5}, {{0, 2, -6.5}, {0, 0, 1}, 0.5}, {{1, 0, -5}, {0, 0, 1}, 0.5}});
    CloudStyle style = style_of(SplatMode::perspective);
    const auto pixel_at = [&](double x, double y, double z, const ChunkLook& look) {
        const Drawn picture = draw(scene, view, style, true, look);
        const double focal = height / 2 / std::tan(0.5);
        return picture.colours[static_cast<std::size_t>(height / 2 + y / z * focal) * width +
                               static_cast<std::size_t>(width / 2 + x / z * focal)];
    };
    const auto near = [](const Pixel& p, const std::array<float, 3>& c) {
        return std::abs(p.r - 255 * c[0]) <= 1 && std::abs(p.g - 255 * c[1]) <= 1 && std::abs(p.b - 255 * c[2]) <= 1;
    };
    style.colour = ColourMode::uniform;
    style.uniform_colour = {0.2f, 0.4f, 0.6f};
    EXPECT_TRUE(near(pixel_at(0, -2, 6, {}), style.uniform_colour));
    style.colour = ColourMode::error;
    ChunkLook look;
    look.error_px = 0.1f;
    EXPECT_TRUE(near(pixel_at(0, -2, 6, look), ramp_colour(0)));
    look.error_px = 64;
    EXPECT_TRUE(near(pixel_at(0, 2, 6.5, look), ramp_colour(1)));
    look.error_px = 4;
    EXPECT_TRUE(near(pixel_at(0, 2, 6.5, look), ramp_colour(3.0f / 7)));
    style.colour = ColourMode::level;
    EXPECT_TRUE(near(pixel_at(0, 2, 6.5, {}), ramp_colour(0)));
    look.level = 1;
    EXPECT_TRUE(near(pixel_at(0, 2, 6.5, look), ramp_colour(1)));
    style.colour = ColourMode::height;  // along z: -6.5 is the bottom, -5 the top
    EXPECT_TRUE(near(pixel_at(0, 2, 6.5, {}), ramp_colour(0)));
    EXPECT_TRUE(near(pixel_at(1, 0, 5, {}), ramp_colour(1)));
    EXPECT_TRUE(near(pixel_at(0, -2, 6, {}), ramp_colour(1.0f / 3)));
}

TEST(SplatPass, LeavesViewportScissorAndStateAsTheyWere)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const SplatScene scene(fine_grid(), field(40, 8, 1.5, 8));
    const DepthFramebuffer framebuffer(width + 40, height + 30);
    // A part of the framebuffer as viewport, and a part of that as scissor.
    glViewport(20, 15, width, height);
    glScissor(50, 40, 60, 50);
    for (const bool scissor : {false, true})
        for (const SplatMode mode : {SplatMode::adaptive, SplatMode::affine, SplatMode::perspective}) {
            glDisable(GL_SCISSOR_TEST);
            framebuffer.clear(true);
            if (scissor) glEnable(GL_SCISSOR_TEST);
            SplatPass pass;
            scene.draw(pass, perspective_view(), style_of(mode), true);
            GLint box[4], viewport[4];
            glGetIntegerv(GL_SCISSOR_BOX, box);
            glGetIntegerv(GL_VIEWPORT, viewport);
            EXPECT_EQ((std::vector<GLint>(box, box + 4)), (std::vector<GLint>{50, 40, 60, 50}));
            EXPECT_EQ((std::vector<GLint>(viewport, viewport + 4)), (std::vector<GLint>{20, 15, width, height}));
            EXPECT_EQ(glIsEnabled(GL_SCISSOR_TEST), scissor ? GL_TRUE : GL_FALSE);
            pass.release();
            const auto pixels = framebuffer.colours();
            std::size_t outside = 0, inside = 0;
            for (int y = 0; y < height + 30; ++y)
                for (int x = 0; x < width + 40; ++x) {
                    const bool in = scissor ? x >= 50 && x < 110 && y >= 40 && y < 90
                                            : x >= 20 && x < 20 + width && y >= 15 && y < 15 + height;
                    (in ? inside : outside) += pixels[static_cast<std::size_t>(y * (width + 40) + x)].a != 0;
                }
            EXPECT_EQ(outside, 0u) << name_of(mode);
            EXPECT_GT(inside, 500u) << name_of(mode);
        }
    glDisable(GL_SCISSOR_TEST);
}
