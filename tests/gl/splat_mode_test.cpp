// Every kind of splat against its own formula in double; what they have in common; and how wrong each is.
#include "tests/gl/splat_scene.h"

#include "pcm/cloud/vector.h"
#include "pcm/gl/gl_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr int width = 160;
constexpr int height = 120;
constexpr double aspect = double(width) / height;
constexpr double infinity = std::numeric_limits<double>::infinity();

// A splat on the screen: coverage and depth at window coordinates; infinite where it does not cover.
using Splat = std::function<double(double x, double y)>;

struct Eye {
    Vec3d place{}, normal{};
    double depth = 0;
    double window[2]{};
    double focal[2]{};  // pixels an eye unit at the splat's depth
};

Eye eye_of(const Camera& view, const Disc& disc)
{
    Eye eye;
    const Matrix& m = view.modelview;
    const Matrix& p = view.projection;
    for (std::size_t r = 0; r < 3; ++r) {
        eye.place[r] = m[12 + r];
        for (std::size_t c = 0; c < 3; ++c) {
            eye.place[r] += m[c * 4 + r] * disc.centre[c];
            eye.normal[r] += m[c * 4 + r] * disc.normal[c];  // of a rotation
        }
    }
    eye.depth = -eye.place[2];
    const double w = p[11] == 0 ? 1 : eye.depth;
    const double size[2] = {double(view.width), double(view.height)};
    for (std::size_t a = 0; a < 2; ++a) {
        eye.window[a] = size[a] / 2 * ((p[a * 5] * eye.place[a] + p[8 + a] * eye.place[2] + p[12 + a]) / w + 1);
        eye.focal[a] = size[a] / 2 * p[a * 5] / w;
    }
    return eye;
}

struct Clip {
    double near, far;
};
Clip clip_of(const Camera& view)
{
    const Matrix& p = view.projection;
    if (p[11] == 0) return {(1 + p[14]) / p[10], (p[14] - 1) / p[10]};
    return {p[14] / (p[10] - 1), p[14] / (p[10] + 1)};
}

Splat square(const Camera& view, const Disc& disc, double side)
{
    const Eye eye = eye_of(view, disc);
    const Clip clip = clip_of(view);
    return [=](double x, double y) {
        const bool inside = std::abs(x - eye.window[0]) <= side / 2 && std::abs(y - eye.window[1]) <= side / 2;
        return inside && eye.depth > clip.near && eye.depth < clip.far ? eye.depth : infinity;
    };
}

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
    const Clip clip = clip_of(view);
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
        splats.push_back(mode == SplatMode::constant  ? constant_splat(view, disc, point_size)
                         : mode == SplatMode::dynamic ? dynamic_splat(view, disc)
                                                      : affine_splat(view, disc));
    return splats;
}

std::vector<DiscHit> picture_of(const Camera& view, const std::vector<Splat>& splats, double margin)
{
    std::vector<DiscHit> pixels;
    for (int row = 0; row < view.height; ++row)
        for (int column = 0; column < view.width; ++column) {
            DiscHit best;
            for (std::size_t s = 0; s < splats.size(); ++s) {
                const double depth = splats[s](column + 0.5, row + 0.5);
                for (int k = 0; k < 9 && margin > 0; ++k)
                    if ((splats[s](column + 0.5 + margin * (k % 3 - 1), row + 0.5 + margin * (k / 3 - 1)) < infinity) !=
                        (depth < infinity))
                        best.certain = false;
                if (!(depth < best.runner_up)) continue;
                best.runner_up = depth;
                if (depth < best.depth) {
                    std::swap(best.depth, best.runner_up);
                    best.disc = static_cast<std::int32_t>(s);
                }
            }
            pixels.push_back(best);
        }
    return pixels;
}

struct Drawn {
    std::vector<Pixel> colours;
    std::vector<float> depths;
};

Drawn draw(const SplatScene& scene, const Camera& view, const CloudStyle& style, bool reversed = true,
           const ChunkLook& look = {})
{
    SplatPass pass;
    const DepthFramebuffer framebuffer(view.width, view.height);
    framebuffer.clear(reversed);
    scene.draw(pass, view, style, reversed, 1, look);
    Drawn picture{framebuffer.colours(), framebuffer.depths()};
    pass.release();
    return picture;
}

void expect_same(const Drawn& picture, const std::vector<DiscHit>& truth, const Camera& view, bool reversed,
                 std::size_t least_covered)
{
    std::size_t covered = 0, wrong = 0;
    double worst = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (!truth[i].certain) continue;
        const int seen = SplatScene::disc_of(picture.colours[i]);
        if (seen != truth[i].disc) {
            const bool tie =
                seen >= 0 && truth[i].disc >= 0 && truth[i].runner_up - truth[i].depth < 1e-4 * truth[i].depth;
            wrong += !tie;
            continue;
        }
        if (seen < 0) continue;
        ++covered;
        worst = std::max(worst, std::abs(depth_of(view, reversed, picture.depths[i]) / truth[i].depth - 1));
    }
    EXPECT_GE(covered, least_covered);
    EXPECT_EQ(wrong, 0u);
    EXPECT_LE(worst, 1e-5);
}

Vec3d direction(std::mt19937_64& random)
{
    std::normal_distribution<double> normal;
    return {normal(random), normal(random), normal(random)};
}

// Discs before an eye at the origin, some of them with their centres beside the view.
std::vector<Disc> field(std::size_t count, std::uint64_t seed, double wideness = 0.8, double size = 1)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> even(-1, 1);
    std::vector<Disc> discs;
    for (std::size_t d = 0; d < count; ++d) {
        const double depth = 6 + 4 * even(random);
        Vec3d normal = direction(random);
        normal[2] += normal[2] < 0 ? -1 : 1;  // seen neither from the side nor, in the affine mode, as if
        discs.push_back({{wideness * depth * even(random), wideness * 0.75 * depth * even(random), -depth},
                         normal,
                         (0.5 + 0.45 * even(random)) * size});
    }
    return discs;
}

Grid fine_grid() { return {{1e-6, 1e-6, 1e-6}, {0, 0, 0}}; }

Camera perspective_view() { return view_of(identity(), perspective(1, aspect, 0.1, 100), width, height); }
Camera parallel_view() { return view_of(translation(0.3, 0, 0), orthographic(5, 5 / aspect, 0.1, 20), width, height); }

}  // namespace

TEST(SplatMode, EachAgreesWithItsFormula)
{
    for (const Profile profile : {Profile::core, Profile::compatibility}) {
        PCM_REQUIRE_GL(context, profile);
        const SplatScene scene(fine_grid(), field(80, 1));
        for (const Camera& view : {perspective_view(), parallel_view()})
            for (const SplatMode mode : {SplatMode::constant, SplatMode::dynamic, SplatMode::affine})
                for (const bool reversed : {true, false}) {
                    if (!reversed && view.projection[11] != 0)
                        continue;  // floats near 1 tell less; splat_disc_test.cpp has that
                    SCOPED_TRACE(testing::Message()
                                 << name_of(mode) << (view.projection[11] == 0 ? ", parallel" : ", perspective"));
                    CloudStyle style = style_of(mode);
                    style.point_size_px = 5;
                    const auto truth = picture_of(view, splats_of(mode, view, scene.discs(view), 5), 0.02);
                    expect_same(draw(scene, view, style, reversed), truth, view, reversed, 500);
                }
    }
}

TEST(SplatMode, DynamicSquaresOfAnySizeAtTheBorder)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // Many centres are outside; then squares that are larger than the driver's points.
    for (const double size : {0.5, 8.0}) {
        const SplatScene scene(fine_grid(), field(60, 2, 1.5, size));
        for (const Camera& view : {perspective_view(), parallel_view()}) {
            const auto truth = picture_of(view, splats_of(SplatMode::dynamic, view, scene.discs(view), 0), 0.02);
            expect_same(draw(scene, view, style_of(SplatMode::dynamic)), truth, view, true, 500);
        }
    }
    // No point vanishes: of a radius of 0 or far away, one pixel is left. (An exact pixel's centre: of a square of 1
    // pixel there is one.)
    std::vector<Disc> tiny;
    for (int d = 0; d < 50; ++d) tiny.push_back({{-4 + 0.16 * d, 0.013 * d, -9}, {0, 0, 1}, d % 2 ? 0.0 : 1e-9});
    const SplatScene scene(fine_grid(), tiny);
    const Drawn picture = draw(scene, perspective_view(), style_of(SplatMode::dynamic));
    EXPECT_EQ(std::count_if(picture.colours.begin(), picture.colours.end(), [](const Pixel& p) { return p.a == 255; }),
              50);
}

TEST(SplatMode, ErrorsAreOrdered)
{
    PCM_REQUIRE_GL(context, Profile::core);
    // Tilted discs over the whole of a wide view.
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
    const std::size_t dynamic_errors = wrong(SplatMode::dynamic);
    EXPECT_LE(perspective_errors, 2u);
    EXPECT_LT(5 * perspective_errors, affine_errors);
    EXPECT_LT(5 * affine_errors, 4 * dynamic_errors);
}

TEST(SplatMode, TwoFramesAreTheSameBitForBit)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const SplatScene scene(fine_grid(), field(80, 4));
    for (const SplatMode mode : {SplatMode::constant, SplatMode::dynamic, SplatMode::affine, SplatMode::perspective}) {
        const Drawn one = draw(scene, perspective_view(), style_of(mode));
        const Drawn two = draw(scene, perspective_view(), style_of(mode));
        EXPECT_TRUE(one.colours == two.colours && one.depths == two.depths) << name_of(mode);
    }
}

TEST(SplatMode, AFixedPointStaysUnderASlowPanAtMapCoordinates)
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
             {SplatMode::constant, SplatMode::dynamic, SplatMode::affine, SplatMode::perspective}) {
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

TEST(SplatMode, DiscsAreAntialiasedSampleBySample)
{
    for (const Profile profile : {Profile::core, Profile::compatibility}) {
        PCM_REQUIRE_GL(context, profile);
        constexpr unsigned samples = 4;
        const DepthFramebuffer framebuffer(width, height, samples);
        std::array<std::array<float, 2>, samples> places{};
        for (unsigned s = 0; s < samples; ++s) glGetMultisamplefv(GL_SAMPLE_POSITION, s, places[s].data());
        for (const Camera& view : {perspective_view(), parallel_view()})
            for (const SplatMode mode : {SplatMode::affine, SplatMode::perspective, SplatMode::dynamic}) {
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
                        wrong += std::abs(alpha - 255 * covered / 4) > 1;
                    }
                EXPECT_EQ(wrong, 0u);
                EXPECT_GT(partly, 100u);
            }
    }
}

TEST(SplatMode, WhatIsMissingIsReplaced)
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
        same(draw(no_normals, view, style_of(SplatMode::perspective)), draw(all, view, style_of(SplatMode::dynamic))));
    EXPECT_TRUE(same(draw(bare, view, style_of(SplatMode::affine)), draw(all, view, style_of(SplatMode::constant))));
    EXPECT_TRUE(same(draw(bare, view, style_of(SplatMode::dynamic)), draw(all, view, style_of(SplatMode::constant))));
    const Drawn uncoloured = draw(no_colours, view, style_of(SplatMode::perspective));
    const Drawn coloured = draw(all, view, style_of(SplatMode::perspective));
    EXPECT_EQ(uncoloured.depths, coloured.depths);
    for (const Pixel& p : uncoloured.colours) EXPECT_TRUE(p.a == 0 || (p.r == 191 && p.g == 191 && p.b == 191));

    // A normal of zero faces the eye; a radius of zero, or one that is no number, draws nothing.
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
    // A least size is one that even such points have.
    ChunkLook look;
    look.least_radius = 0.25f;
    look.least_px = 100;
    const Drawn c = draw(scene, view, style_of(SplatMode::perspective), true, look);
    for (int d = 0; d < 4; ++d)
        EXPECT_TRUE(std::any_of(c.colours.begin(), c.colours.end(), [&](const Pixel& p) {
            return SplatScene::disc_of(p) == d;
        })) << d;
}

// Small splats become as large as is asked for, in every mode and place; larger ones stay as they are.
TEST(SplatMode, GapsAreFilled)
{
    PCM_REQUIRE_GL(context, Profile::core);
    for (const Camera& view : {perspective_view(), parallel_view()})
        for (const SplatMode mode :
             {SplatMode::constant, SplatMode::dynamic, SplatMode::affine, SplatMode::perspective})
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
                    const bool square = mode == SplatMode::constant || mode == SplatMode::dynamic;
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

TEST(SplatMode, ColoursByLevelErrorHeightAndOneForAll)
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

TEST(SplatMode, LeavesViewportScissorAndStateAsTheyWere)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const SplatScene scene(fine_grid(), field(40, 8, 1.5, 8));
    const DepthFramebuffer framebuffer(width + 40, height + 30);
    // A part of the framebuffer, and of that a part.
    glViewport(20, 15, width, height);
    glScissor(50, 40, 60, 50);
    for (const bool scissor : {false, true})
        for (const SplatMode mode : {SplatMode::dynamic, SplatMode::affine, SplatMode::perspective}) {
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
