// Composition of a picture into the host's framebuffer: depth, multisampling, eye-dome lighting.
#include "tests/gl/gl_support.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>

using namespace pcm;
using namespace pcm::test;

namespace {

std::vector<float> depths_of(const Framebuffer& framebuffer)
{
    std::vector<float> depths(static_cast<std::size_t>(framebuffer.width() * framebuffer.height()));
    glReadPixels(0, 0, framebuffer.width(), framebuffer.height(), GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
    return depths;
}

double mean_brightness(const std::vector<Pixel>& pixels)
{
    double sum = 0, lit = 0;
    for (const Pixel& p : pixels)
        if (p.a) {
            sum += p.g;
            ++lit;
        }
    return lit > 0 ? sum / lit : 0;
}

// How much darker eye-dome lighting makes what this view shows of a cloud: the mean over all pixels five away from any
// empty one, and the share of these that loses more than a quarter.
struct Darkening {
    double mean = 0, rims = 0;
};
Darkening darkening(const std::shared_ptr<PointCloud>& cloud, const Camera& view, const RenderOptions& options)
{
    const Framebuffer framebuffer(view.width, view.height);
    std::vector<std::vector<Pixel>> pictures;
    for (const float strength : {0.0f, 1.0f}) {
        Drawing drawing(cloud);
        drawing.style = CloudStyle();
        drawing.style.colour = ColourMode::uniform;
        drawing.style.uniform_colour = {1, 1, 1};
        RenderOptions with = options;
        with.eye_dome = strength;
        draw_until_done(drawing, framebuffer, view, {0, 0, 0}, with);
        pictures.push_back(framebuffer.read());
        drawing.release();
    }
    Darkening sum;
    std::size_t inside = 0;
    for (int y = 5; y + 5 < view.height; ++y)
        for (int x = 5; x + 5 < view.width; ++x) {
            const auto at = [&](int dx, int dy) { return static_cast<std::size_t>((y + dy) * view.width + x + dx); };
            bool is_inside = true;
            for (int k = 0; k < 121; ++k) is_inside = is_inside && pictures[0][at(k % 11 - 5, k / 11 - 5)].a == 255;
            if (!is_inside) continue;
            const double dark = 1 - pictures[1][at(0, 0)].g / 255.0;
            ++inside;
            sum.mean += dark;
            sum.rims += dark > 0.25;
        }
    EXPECT_GT(inside, 3000u);
    return {sum.mean / static_cast<double>(inside), sum.rims / static_cast<double>(inside)};
}

}  // namespace

// The host's objects in front of and behind the cloud; the resulting depth is in the host's convention.
TEST(Compositor, IsDepthTestedAgainstTheHostsPicture)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "flat", grid_at({0, 0, 0}), sheet(101, [](std::int32_t) { return 0; }), 2000);
    const Framebuffer framebuffer(100, 100);
    const Matrix projection = perspective(0.9, 1, 0.5, 100);
    const Camera view = view_of(translation(-5, -5, -10), projection, 100, 100);
    const auto window_depth = [&](double z) { return ((projection[10] * z + projection[14]) / -z + 1) / 2; };
    for (const unsigned samples : {1u, 4u})
        for (const float eye_dome : {0.0f, 1.0f})
            for (const double range_end : {1.0, 0.5}) {
                Drawing drawing(cloud);
                drawing.style.point_size_px = 4;
                RenderOptions options = everything();
                options.samples = samples;
                options.eye_dome = eye_dome;
                FrameReport report;
                for (int frame = 0; frame < 1000; ++frame) {
                    framebuffer.clear();
                    // Left half: an object of the host, 2 in front of the sheet; right half: 2 behind it.
                    glEnable(GL_SCISSOR_TEST);
                    for (const bool right : {false, true}) {
                        glScissor(right ? 50 : 0, 0, 50, 100);
                        glClearColor(1, 0, 0, 1);
                        glClearDepth(range_end * window_depth(right ? -12 : -8));
                        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
                    }
                    glClearDepth(1);
                    glScissor(10, 10, 80, 80);  // the host's, which must not crop the picture
                    glDepthRange(0, range_end);
                    report = drawing.draw(view, {0, 0, 0}, options);
                    EXPECT_TRUE(glIsEnabled(GL_SCISSOR_TEST));
                    glDepthRange(0, 1);
                    glDisable(GL_SCISSOR_TEST);
                    ASSERT_EQ(report.error, "");
                    if (!report.refining) break;
                }
                EXPECT_TRUE(report.full_resolution);
                EXPECT_EQ(report.samples, samples);
                const auto pixels = framebuffer.read();
                const auto depths = depths_of(framebuffer);
                const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * 100 + x); };
                for (int y = 20; y < 80; y += 7) {
                    EXPECT_EQ(pixels[at(30, y)].g, 0) << "the sheet shines through";
                    EXPECT_NEAR(depths[at(30, y)], range_end * window_depth(-8), 1e-6);
                    EXPECT_GT(pixels[at(70, y)].g, 200) << "the sheet is not there";
                    EXPECT_NEAR(depths[at(70, y)], range_end * window_depth(-10), 1e-6);
                }
                drawing.release();
            }
}

// Partly covered pixels at the edges of squares, none inside.
TEST(Compositor, SeveralSamplesSmoothEdges)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    std::vector<LasPoint> points(1);
    points[0].x = points[0].y = 5033;
    points.push_back({});
    points[1].x = points[1].y = 1000;
    const auto cloud = make_cloud(folder, "two", grid_at({0, 0, 0}), points, 1000);
    const Framebuffer framebuffer(100, 100);
    const Camera view = view_of(translation(-5, -5, -10), orthographic(5, 5, 1, 100), 100, 100);
    for (const unsigned samples : {1u, 4u, 1000u}) {
        SCOPED_TRACE(samples);
        Drawing drawing(cloud);
        drawing.style.point_size_px = 20;
        RenderOptions options = everything();
        options.samples = samples;
        const FrameReport report = draw_until_done(drawing, framebuffer, view, {0, 0, 0}, options);
        if (samples > 4) {
            EXPECT_LE(report.samples, 8u);  // more are of no use: see RenderTarget::most_samples
            EXPECT_GE(report.samples, 4u);
        }
        std::size_t partly = 0, whole = 0;
        for (const Pixel& p : framebuffer.read()) {
            partly += p.a > 0 && p.a < 255;
            whole += p.a == 255;
            if (p.a == 255) EXPECT_EQ(p.r, 255);
        }
        EXPECT_GE(whole, 2u * 19 * 19);
        if (samples == 1)
            EXPECT_EQ(partly, 0u);
        else
            EXPECT_GT(partly, 15u);
        drawing.release();
    }
}

// Dots with gaps between them are not a surface: one that is next to a nearer one stays bright.
TEST(Compositor, EyeDomeLightingSparesPointsThatStandAlone)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    // Pairs, 10 pixels from each other: one point of each pair is behind the other, and two pixels away from it.
    std::vector<LasPoint> points;
    for (std::int32_t i = 0; i < 9; ++i)
        for (std::int32_t j = 0; j < 9; ++j)
            for (const bool far : {false, true}) {
                LasPoint p;
                p.x = 1000 * (i - 4) + (far ? 200 : 0);
                p.y = 1000 * (j - 4);
                p.z = far ? -200 : 0;
                points.push_back(p);
            }
    const auto cloud = make_cloud(folder, "pairs", grid_at({0, 0, 0}), points);
    const Framebuffer framebuffer(100, 100);
    const Camera view = view_of(translation(0, 0, -12), orthographic(5, 5, 1, 100), 100, 100);
    const auto brightness = [&](float strength) {
        Drawing drawing(cloud);
        drawing.style.colour = ColourMode::uniform;
        drawing.style.uniform_colour = {1, 1, 1};
        RenderOptions options = everything();
        options.eye_dome = strength;
        draw_until_done(drawing, framebuffer, view, {0, 0, 0}, options);
        const auto pixels = framebuffer.read();
        drawing.release();
        EXPECT_GT(count_lit(pixels), 500u);
        return mean_brightness(pixels);
    };
    EXPECT_GT(brightness(1), 0.9 * brightness(0));
}

// A face-on plane is unchanged; a step gets a shadow on its lower side, for any unit of length and either projection.
TEST(Compositor, EyeDomeLightingShowsSteps)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto flat = make_cloud(folder, "flat", grid_at({0, 0, 0}), sheet(101, [](std::int32_t) { return 0; }), 2000);
    const auto step = make_cloud(folder, "step", grid_at({0, 0, 0}),
                                 sheet(101, [](std::int32_t x) { return x < 50 ? 0 : 1500; }), 2000);
    const Framebuffer framebuffer(100, 100);
    double darkest = 1e9;
    for (const bool parallel : {false, true})
        for (const double unit : {1.0, 1e-4, 1e4})
            for (const unsigned samples : {1u, 4u}) {
                Matrix scaled = translation(-5 * unit, -5 * unit, -12 * unit);
                for (const std::size_t k : {0u, 5u, 10u}) scaled[k] = unit;
                const Matrix projection = parallel ? orthographic(4 * unit, 4 * unit, unit, 100 * unit)
                                                   : perspective(0.7, 1, 0.1 * unit, 100 * unit);
                const Camera view = view_of(scaled, projection, 100, 100);
                const auto brightness = [&](const std::shared_ptr<PointCloud>& cloud, float strength) {
                    Drawing drawing(cloud);
                    drawing.style.point_size_px = 5;
                    RenderOptions options = everything();
                    options.samples = samples;
                    options.eye_dome = strength;
                    draw_until_done(drawing, framebuffer, view, {0, 0, 0}, options);
                    const auto pixels = framebuffer.read();
                    drawing.release();
                    return pixels;
                };
                EXPECT_NEAR(mean_brightness(brightness(flat, 1)), 255, 1);
                EXPECT_NEAR(mean_brightness(brightness(step, 0)), 255, 1);
                const auto shaded = brightness(step, 1);
                const auto stronger = brightness(step, 3);
                EXPECT_LT(mean_brightness(shaded), 254);
                EXPECT_LT(mean_brightness(stronger), mean_brightness(shaded));
                // The middle row: dark only on the lower side of the step.
                int least = 255, place = 0;
                for (int x = 5; x < 95; ++x) {
                    const int g = shaded[static_cast<std::size_t>(50 * 100 + x)].g;
                    if (g < least) {
                        least = g;
                        place = x;
                    }
                }
                EXPECT_LT(least, 200) << parallel << " " << unit << " " << samples;
                EXPECT_NEAR(place, 48, 6);
                // On the upper side a soft shade, of the second ring, and that only near the edge.
                EXPECT_GT(shaded[static_cast<std::size_t>(50 * 100 + place + 6)].g, 230);
                EXPECT_GT(shaded[static_cast<std::size_t>(50 * 100 + place + 12)].g, 250);
                darkest = std::min(darkest, static_cast<double>(least));
            }
    EXPECT_GE(darkest, 0);
}

// A wall is not shaded, seen face-on or at a grazing angle, near or far, in either projection, moving or at rest: its
// slope is not a relief, and neither are the splats that it is drawn with.
// Not under the address sanitizer: much drawing in software.
TEST(Compositor, PCM_NOT_UNDER_ADDRESS(EyeDomeLightingLeavesPlanesAsTheyAre))
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto points = random_points(80000, 20000, 5);
    for (LasPoint& p : points) p.x -= 10000, p.y -= 10000, p.z = 0;
    const auto cloud = make_cloud(folder, "plane", grid_at({0, 0, 0}), points);
    constexpr double degree = 3.14159265358979 / 180;
    for (const double tilt : {0.0, 60.0, 85.0})
        for (const double distance : {4.0, 30.0})
            for (const bool parallel : {false, true}) {
                Matrix modelview = rotation_x(-tilt * degree);
                modelview[14] = -distance;
                const double half = tilt < 80 ? 0.15 * distance : 0.03 * distance;
                const Matrix projection = parallel ? orthographic(half, half, 0.1, 200)
                                                   : perspective(2 * std::atan(half / distance), 1, 0.1, 200);
                const Camera view = view_of(modelview, projection, 300, 300);
                for (const bool moving : {false, true})
                    for (const unsigned samples : {1u, 4u}) {
                        if (samples > 1 && (moving || parallel)) continue;
                        RenderOptions options = everything();
                        options.samples = samples;
                        options.converge = !moving;
                        const Darkening dark = darkening(cloud, view, options);
                        SCOPED_TRACE(testing::Message()
                                     << tilt << " degrees from " << distance << (parallel ? ", parallel" : "")
                                     << (moving ? ", moving" : "") << ", " << samples << " samples: " << dark.mean);
                        EXPECT_LT(dark.mean, tilt == 0 ? 0.001 : tilt < 80 ? 0.005 : moving ? 0.1 : 0.04);
                        EXPECT_LT(dark.rims, tilt < 80 ? 0.002 : moving ? 0.17 : 0.06);
                    }
            }
}

// While the view moves only a quarter of the pixels are lit: it looks the same, whatever the size of the picture, and
// flat parts are not shaded.
TEST(Compositor, EyeDomeLightingOfAMovingViewIsThatOfARestingOne)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "step", grid_at({0, 0, 0}),
                                  sheet(101, [](std::int32_t x) { return x < 50 ? 0 : 1500; }), 20000);
    for (const int size : {100, 101})
        for (const unsigned samples : {1u, 4u}) {
            const Framebuffer framebuffer(size, size);
            Drawing drawing(cloud);
            drawing.style.splats = SplatMode::adaptive;  // squares while it moves
            RenderOptions options;
            options.frame_budget_ms = 1e6;
            options.samples = samples;
            const auto row = [&](double shift) {
                framebuffer.clear();
                const Camera view =
                    view_of(translation(-5 + shift, -5, -12), perspective(0.7, 1, 0.1, 100), size, size);
                const FrameReport report = drawing.draw(view, {0, 0, 0}, options);
                EXPECT_EQ(report.error, "");
                const auto pixels = framebuffer.read();
                return std::pair(report, std::vector<Pixel>(pixels.begin() + size / 2 * size,
                                                            pixels.begin() + (size / 2 + 1) * size));
            };
            auto moving = row(0);
            for (int frame = 1; frame < 500 && (frame < 4 || moving.first.nodes_missing > 0); ++frame)
                moving = row(1e-6 * (frame % 2));
            EXPECT_TRUE(moving.first.refining);
            auto rest = row(0);
            for (int frame = 0; frame < 500 && rest.first.refining; ++frame) rest = row(0);
            EXPECT_FALSE(rest.first.refining);
            int dark[2] = {0, 0};
            for (int x = 3; x < size - 3; ++x) {
                const std::size_t at = static_cast<std::size_t>(x);
                dark[0] += 255 - moving.second[at].g;
                dark[1] += 255 - rest.second[at].g;
                if (x < size / 2 - 20 || x > size / 2 + 20) EXPECT_GT(moving.second[at].g, 250) << x;
            }
            EXPECT_GT(dark[1], 300);
            EXPECT_NEAR(dark[0], dark[1], 0.4 * dark[1]) << size << " " << samples;
            drawing.release();
        }
}

// A wall as a depth camera measures it: patches that lie a step apart are as flat as the wall was. What stands before
// it still has an edge, and patches whose depths are not in steps are relief.
TEST(Compositor, EyeDomeLightingHidesTheStepsOfADepthCamera)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto points = random_points(60000, 20000, 5);
    std::vector<std::int32_t> heights(23 * 23);
    std::mt19937 random(3);
    for (std::int32_t& height : heights) height = 500 * std::int32_t(random() % 3);
    for (LasPoint& p : points) p.z = heights[static_cast<std::size_t>(p.x / 900 * 23 + p.y / 900)];
    auto rough = points, before = points;
    for (LasPoint& p : rough) p.z += std::int32_t(random() % 50);
    for (LasPoint& p : before)
        if (p.x > 8000 && p.x < 12000) p.z += 4000;
    const Camera view = view_of(translation(-10, -10, -30), perspective(0.5, 1, 0.5, 100), 300, 300);
    for (const unsigned samples : {1u, 4u}) {
        RenderOptions options = everything();
        options.samples = samples;
        const std::string n = std::to_string(samples);
        const Darkening steps = darkening(make_cloud(folder, "steps" + n, grid_at({0, 0, 0}), points), view, options);
        const Darkening relief = darkening(make_cloud(folder, "relief" + n, grid_at({0, 0, 0}), rough), view, options);
        const Darkening edge = darkening(make_cloud(folder, "edge" + n, grid_at({0, 0, 0}), before), view, options);
        SCOPED_TRACE(testing::Message() << samples << " samples: " << steps.mean << " " << relief.mean << " "
                                        << edge.mean);
        EXPECT_LT(steps.mean, (samples == 1 ? 0.35 : 0.6) * relief.mean);
        EXPECT_GT(relief.mean, 0.03);
        EXPECT_LT(steps.rims, 0.005);
        EXPECT_GT(edge.rims, 3 * steps.rims);
    }
}

// A crown is not drawn as a heap of balls with black rims, and yet what lies in front of something else stands out.
TEST(Compositor, EyeDomeLightingHasNoRimsAroundSplats)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    // Twigs in a ball of 8 units.
    std::vector<LasPoint> points = random_points(20000, 8000, 9);
    points.erase(
        std::remove_if(points.begin(), points.end(),
                       [](const LasPoint& p) { return std::hypot(p.x - 4000.0, p.y - 4000.0, p.z - 4000.0) > 4000; }),
        points.end());
    const auto crown = make_cloud(folder, "crown", grid_at({0, 0, 0}), points);
    const Camera view = view_of(translation(-4, -4, -16), perspective(0.6, 1, 0.5, 100), 200, 200);
    const Darkening rims = darkening(crown, view, everything());
    EXPECT_LT(rims.mean, 0.035);
    EXPECT_LT(rims.rims, 0.045);
    // A second one in front of it, three units wide.
    for (const LasPoint& p : std::vector<LasPoint>(points)) {
        LasPoint near = p;
        near.x = 2500 + 3 * p.x / 8;
        near.y = 2500 + 3 * p.y / 8;
        near.z = 9500 + 3 * p.z / 8;
        points.push_back(near);
    }
    const auto two = make_cloud(folder, "two", grid_at({0, 0, 0}), points);
    EXPECT_GT(darkening(two, view, everything()).rims, 0.004);
}

// Leaves that float before a meadow leave no dark rings on it, however large they are on the screen.
TEST(Compositor, EyeDomeLightingHasNoRingsBehindLeaves)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto points = random_points(80000, 20000, 5);
    for (LasPoint& p : points) p.x -= 10000, p.y -= 10000, p.z = 0;
    std::vector<LasPoint> leaves = random_points(800, 8000, 7);
    for (LasPoint& p : leaves) {
        p.x -= 4000, p.y -= 4000, p.z = 2000 + p.z / 2;
        points.push_back(p);
    }
    const auto cloud = make_cloud(folder, "meadow", grid_at({0, 0, 0}), points);
    const Camera view = view_of(translation(0, 0, -16), perspective(0.5, 1, 0.5, 100), 300, 300);
    const Darkening dark = darkening(cloud, view, everything());
    SCOPED_TRACE(testing::Message() << dark.mean << " " << dark.rims);
    EXPECT_LT(dark.rims, 0.02);
    // What stands before it as a surface has an outline.
    for (LasPoint& p : leaves) p.x /= 4, p.y /= 4, p.z = 3000;
    points.resize(80000);
    for (int k = 0; k < 20; ++k)
        for (LasPoint p : leaves) {
            p.x += 100 * (k % 5), p.y += 100 * (k / 5);
            points.push_back(p);
        }
    EXPECT_GT(darkening(make_cloud(folder, "board", grid_at({0, 0, 0}), points), view, everything()).rims, 0.005);
}
