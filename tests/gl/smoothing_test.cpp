// A resting view as the mean of frames at sub-pixel offsets.
#include "pcm/gl/draw/smoothing.h"
#include "pcm/view/pixel_offset.h"
#include "tests/gl/gl_support.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr int wide = 160, high = 120;

Camera view_of_cube(bool parallel = false)
{
    return view_of(overview(10), parallel ? orthographic(8, 6, -100, 100) : perspective(0.9, 4.0 / 3, 0.1, 1000), wide,
                   high);
}

RenderOptions smooth(unsigned frames, float eye_dome = 0, unsigned samples = 1)
{
    RenderOptions options = everything();
    options.smooth_frames = frames;
    options.eye_dome = eye_dome;
    options.samples = samples;
    return options;
}

std::vector<float> depths_of(const Framebuffer& framebuffer)
{
    std::vector<float> depths(static_cast<std::size_t>(framebuffer.width() * framebuffer.height()));
    glReadPixels(0, 0, framebuffer.width(), framebuffer.height(), GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
    return depths;
}

// Colours times coverage, and coverage, 0 to 255.
using Sum = std::array<double, 4>;
Sum premultiplied(const Pixel& p) { return {double(p.r), double(p.g), double(p.b), double(p.a)}; }

// The mean of pictures that are drawn one by one by cameras at the offsets; `drawing` without smoothing.
std::vector<Sum> mean_of_pictures(Drawing& drawing, const Framebuffer& framebuffer, const Camera& view,
                                  const Vec3d& origin, const RenderOptions& options, unsigned frames)
{
    std::vector<Sum> mean(static_cast<std::size_t>(view.width * view.height));
    for (unsigned i = 0; i < frames; ++i) {
        draw_until_done(drawing, framebuffer, shifted(view, pixel_offset(i, frames)), origin, options);
        const auto pixels = framebuffer.read();
        for (std::size_t k = 0; k < mean.size(); ++k)
            for (std::size_t c = 0; c < 4; ++c) mean[k][c] += premultiplied(pixels[k])[c] / frames;
    }
    return mean;
}

double largest_difference(const std::vector<Pixel>& a, const std::vector<Sum>& b)
{
    double largest = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
        for (std::size_t c = 0; c < 4; ++c) largest = std::max(largest, std::fabs(premultiplied(a[k])[c] - b[k][c]));
    return largest;
}

std::vector<Sum> sums_of(const std::vector<Pixel>& pixels)
{
    std::vector<Sum> sums;
    for (const Pixel& p : pixels) sums.push_back(premultiplied(p));
    return sums;
}

// How much the red of pixels that both cover changes.
double change_of(const std::vector<Sum>& before, const std::vector<Sum>& after)
{
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < before.size(); ++k) {
        if (before[k][3] < 254.5 || after[k][3] < 254.5) continue;
        sum += std::fabs(before[k][0] - after[k][0]);
        ++count;
    }
    return sum / count;
}

std::size_t partly_covered(const std::vector<Pixel>& pixels)
{
    return static_cast<std::size_t>(
        std::count_if(pixels.begin(), pixels.end(), [](const Pixel& p) { return p.a > 0 && p.a < 255; }));
}

CloudStyle coloured(SplatMode mode)
{
    CloudStyle style;
    style.splats = mode;
    style.colour = ColourMode::rgb;
    style.point_size_px = 3;
    return style;
}

}  // namespace

TEST(Smoothing, FramesAreWorthwhileWhereTheyAreFewPoints)
{
    EXPECT_EQ(frames_worthwhile(16, 0), 16u);
    EXPECT_EQ(frames_worthwhile(16, 12'500'000), 16u);
    EXPECT_EQ(frames_worthwhile(16, 12'500'001), 15u);
    EXPECT_EQ(frames_worthwhile(16, 50'000'000), gl_tuning().smoothing.min_frames);
    EXPECT_EQ(frames_worthwhile(16, 50'000'001), 1u);
    EXPECT_EQ(frames_worthwhile(16, ~std::uint64_t(0)), 1u);
    EXPECT_EQ(frames_worthwhile(1, 1000), 1u);
    EXPECT_EQ(frames_worthwhile(0, 1000), 1u);
    EXPECT_EQ(frames_worthwhile(2, 1000), 2u);  // asked for
    EXPECT_EQ(frames_worthwhile(2, 150'000'000), 1u);
    EXPECT_EQ(frames_worthwhile(std::numeric_limits<unsigned>::max(), 1), most_smooth_frames);
}

// It is the mean of the pictures that cameras at the offsets have, for each kind of splats, projection and lighting,
// and with several samples.
// Not under the address sanitizer: much drawing in software.
TEST(Smoothing, PCM_NOT_UNDER_ADDRESS(IsTheMeanOfPicturesAtTheOffsets))
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 21), 1500);
    const Framebuffer framebuffer(wide, high);
    for (const bool parallel : {false, true})
        for (const SplatMode mode : {SplatMode::constant, SplatMode::adaptive})
            for (const auto& [eye_dome, samples] : {std::pair{0.0f, 1u}, {1.0f, 1u}, {0.0f, 4u}, {1.0f, 4u}}) {
                SCOPED_TRACE(testing::Message() << parallel << " " << int(mode) << " " << eye_dome << " " << samples);
                const Camera view = view_of_cube(parallel);
                Drawing drawing(cloud);
                drawing.style = coloured(mode);
                const auto mean =
                    mean_of_pictures(drawing, framebuffer, view, map_offset, smooth(1, eye_dome, samples), 5);
                const FrameReport report =
                    draw_until_done(drawing, framebuffer, view, map_offset, smooth(5, eye_dome, samples));
                EXPECT_EQ(report.frames_averaged, 5u);
                EXPECT_EQ(report.smooth_frames, 5u);
                EXPECT_TRUE(report.full_resolution);
                const auto pixels = framebuffer.read();
                EXPECT_GT(partly_covered(pixels), 50u);
                // Both are rounded to bytes: the pictures before they are averaged, the mean after that; where pixels
                // are partly covered colours and coverage are, and their product again.
                EXPECT_LT(largest_difference(pixels, mean), samples > 1 ? 1.51 : 1.01);
                drawing.release();
            }
}

// Tiles of a snapshot, for example, do not converge. They are averaged, too, and keep the depth of the picture.
TEST(Smoothing, ViewsThatDoNotConvergeHaveTheirMean)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 21), 1500);
    const Framebuffer framebuffer(wide, high);
    Drawing drawing(cloud);
    drawing.style = coloured(SplatMode::adaptive);
    RenderOptions options = smooth(1);
    options.converge = false;
    const auto mean = mean_of_pictures(drawing, framebuffer, view_of_cube(), map_offset, options, 6);
    draw_until_done(drawing, framebuffer, view_of_cube(), map_offset, options);
    const auto depths = depths_of(framebuffer);
    options.smooth_frames = 6;
    EXPECT_EQ(draw_until_done(drawing, framebuffer, view_of_cube(), map_offset, options).frames_averaged, 6u);
    EXPECT_LT(largest_difference(framebuffer.read(), mean), 1.01);
    const auto now = depths_of(framebuffer);
    for (std::size_t k = 0; k < depths.size(); ++k)
        if (depths[k] < 1) EXPECT_EQ(now[k], depths[k]) << k;
    drawing.release();
}

// An edge's coverage is the weight of what lies on its side under the filter: with n x n cells of offsets a straight
// edge is off by a cell at most, and the more frames the less.
TEST(Smoothing, CoverageBecomesTheWeightUnderTheFilter)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    std::vector<LasPoint> points(1);
    points[0].x = points[0].y = 5033;
    const auto cloud = make_cloud(folder, "one", grid_at({0, 0, 0}), points, 1000);
    const Framebuffer framebuffer(100, 100);
    const Camera view = view_of(translation(-5, -5, -10), orthographic(5, 5, 1, 100), 100, 100);
    // A square of 21 pixels around (50.33, 50.33) of the hundred.
    // The share of a tent's weight before `place`, relative to its middle.
    const auto weight_before = [](double place) {
        const double t = std::clamp(place / filter_reach, -1.0, 1.0);
        return 0.5 + t - 0.5 * t * std::fabs(t);
    };
    const auto overlap = [&](int pixel) {
        return weight_before(50.33 + 10.5 - (pixel + 0.5)) - weight_before(50.33 - 10.5 - (pixel + 0.5));
    };
    double before = 1;
    for (const unsigned frames : {4u, 16u, 64u, 256u}) {
        Drawing drawing(cloud);
        drawing.style.point_size_px = 21;
        EXPECT_EQ(draw_until_done(drawing, framebuffer, view, {0, 0, 0}, smooth(frames)).frames_averaged, frames);
        const auto pixels = framebuffer.read();
        double worst = 0;
        for (int y = 0; y < 100; ++y)
            for (int x = 0; x < 100; ++x)
                worst = std::max(worst, std::fabs(pixels[static_cast<std::size_t>(y * 100 + x)].a / 255.0 -
                                                  overlap(x) * overlap(y)));
        EXPECT_LT(worst, 1.1 * before) << frames;
        EXPECT_LT(worst, 2 / std::sqrt(frames) + 0.01) << frames;
        if (frames == 256) EXPECT_LT(worst, 0.02);
        before = worst;
        drawing.release();
    }
}

// What reads the host's depth, MeshLab's tools among others, finds what it finds without smoothing.
TEST(Smoothing, DepthStaysThatOfThePicture)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 21), 1500);
    const Framebuffer framebuffer(wide, high);
    const Camera view = view_of_cube();
    for (const unsigned samples : {1u, 4u}) {
        Drawing drawing(cloud);
        drawing.style = coloured(SplatMode::adaptive);
        draw_until_done(drawing, framebuffer, view, map_offset, smooth(1, 1, samples));
        const auto plain = depths_of(framebuffer);
        draw_until_done(drawing, framebuffer, view, map_offset, smooth(16, 1, samples));
        const auto mean = depths_of(framebuffer);
        const auto pixels = framebuffer.read();
        std::size_t added = 0;
        for (int y = 1; y + 1 < high; ++y)
            for (int x = 1; x + 1 < wide; ++x) {
                const auto at = [&](int dx, int dy) { return static_cast<std::size_t>((y + dy) * wide + x + dx); };
                if (plain[at(0, 0)] < 1) {
                    EXPECT_EQ(mean[at(0, 0)], plain[at(0, 0)]);
                } else if (pixels[at(0, 0)].a > 0) {
                    // Only the other frames cover it: the depth of a neighbour.
                    float nearest = 1;
                    for (int k = 0; k < 9; ++k) nearest = std::min(nearest, plain[at(k % 3 - 1, k / 3 - 1)]);
                    EXPECT_EQ(mean[at(0, 0)], nearest);
                    added += nearest < 1;
                }
            }
        EXPECT_GT(added, 20u);
        drawing.release();
    }
}

// The same mean whatever the budgets are and although video memory holds a third of the points; while it grows, the
// report says how far it is, and then nothing is drawn any more.
TEST(Smoothing, IsTheSameWhateverTheBudgets)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(60000, 10000, 21), 1500);
    const Framebuffer framebuffer(wide, high);
    const Camera view = view_of_cube();
    std::vector<Pixel> first, unsmoothed;
    for (int way = 0; way < 3; ++way) {
        L1Options l1;
        l1.block_bytes = 1u << 20;
        if (way > 0) l1.capacity_bytes = 1u << 20;
        Drawing drawing(cloud, l1);
        drawing.style = coloured(SplatMode::adaptive);
        RenderOptions options = smooth(4);
        options.point_budget = way == 2 ? 9000 : 30000;
        options.upload_budget_ms = way == 1 ? 0 : 3;
        if (way == 0) options = smooth(4);
        FrameReport report;
        unsigned averaged = 1;
        int frames = 0;
        for (; frames < 5000; ++frames) {
            framebuffer.clear();
            report = drawing.draw(view, map_offset, options);
            ASSERT_EQ(report.error, "");
            EXPECT_GE(report.frames_averaged, averaged);
            averaged = report.frames_averaged;
            if (report.smoothing) {
                EXPECT_TRUE(report.full_resolution && report.refining);
                EXPECT_EQ(report.points_drawn, 60000u);
                EXPECT_EQ(report.nodes_missing, 0u);
                EXPECT_LE(report.points_added, options.point_budget);
                if (averaged == 1 && way == 0) unsmoothed = framebuffer.read();
            }
            if (!report.refining) break;
            if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        EXPECT_EQ(averaged, 4u);
        const auto pixels = framebuffer.read();
        if (way == 0) first = pixels;
        EXPECT_TRUE(pixels == first) << "way " << way;
        framebuffer.clear();
        report = drawing.draw(view, map_offset, options);
        EXPECT_TRUE(report.full_resolution && !report.refining && !report.smoothing && report.points_added == 0);
        EXPECT_EQ(report.frames_averaged, 4u);
        EXPECT_TRUE(framebuffer.read() == first);
        drawing.release();
    }
    EXPECT_FALSE(unsmoothed.empty());
    EXPECT_FALSE(first == unsmoothed);
}

// A view that moves is drawn as it would be without: at once, and no frame of the former place is in it.
TEST(Smoothing, EndsWhenTheViewMoves)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 21), 1500);
    const Framebuffer framebuffer(wide, high);
    const Camera there = view_of(overview(11), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);
    for (const SplatMode mode : {SplatMode::constant, SplatMode::adaptive}) {
        Drawing drawing(cloud);
        drawing.style = coloured(mode);
        RenderOptions options = smooth(8);
        draw_until_done(drawing, framebuffer, there, map_offset, smooth(1));
        std::vector<Pixel> plain;  // first frame there
        for (int smoothed = 0; smoothed < 20; ++smoothed) {
            draw_until_done(drawing, framebuffer, view_of_cube(), map_offset, smooth(1));
            for (int i = 0; i < smoothed; ++i) {
                framebuffer.clear();
                drawing.draw(view_of_cube(), map_offset, options);
            }
            framebuffer.clear();
            const FrameReport report = drawing.draw(there, map_offset, options);
            EXPECT_EQ(report.frames_averaged, 1u);
            if (smoothed == 0) plain = framebuffer.read();
            EXPECT_TRUE(framebuffer.read() == plain) << smoothed;
        }
        drawing.release();
    }
}

// Another strength of eye-dome lighting, more frames or none begin a new mean of the same points.
TEST(Smoothing, BeginsAnewWhenItsFramesWouldBeOthers)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 21), 1500);
    const Framebuffer framebuffer(wide, high);
    const auto fresh = [&](const RenderOptions& options) {
        Drawing drawing(cloud);
        drawing.style = coloured(SplatMode::adaptive);
        draw_until_done(drawing, framebuffer, view_of_cube(), map_offset, options);
        drawing.release();
        return framebuffer.read();
    };
    Drawing drawing(cloud);
    drawing.style = coloured(SplatMode::adaptive);
    draw_until_done(drawing, framebuffer, view_of_cube(), map_offset, smooth(8));
    for (const RenderOptions& options : {smooth(8, 2), smooth(16, 2), smooth(1, 2), smooth(4)}) {
        // In the middle of a frame, too.
        RenderOptions slow = smooth(12, 3);
        slow.point_budget = 3000;
        for (int i = 0; i < 5; ++i) drawing.draw(view_of_cube(), map_offset, slow);
        const FrameReport report = draw_until_done(drawing, framebuffer, view_of_cube(), map_offset, options);
        EXPECT_EQ(report.frames_averaged, options.smooth_frames);
        const auto pixels = framebuffer.read();
        EXPECT_TRUE(pixels == fresh(options)) << options.smooth_frames << " " << options.eye_dome;
    }
    drawing.release();
}

// Views that do not converge, as tiles of a snapshot, are smoothed as well, and tiles show what a larger picture does.
TEST(Smoothing, TilesAreTheLargerPicture)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(40000, 10000, 21), 1500);
    RenderOptions options = smooth(8);
    options.converge = false;
    options.paraboloids = true;
    for (const bool parallel : {false, true}) {
        const Camera view = view_of_cube(parallel);
        Camera large = view;
        large.width *= 2, large.height *= 2;
        const auto drawn = [&](const Camera& camera) {
            const Framebuffer framebuffer(camera.width, camera.height);
            Drawing drawing(cloud);
            drawing.style = coloured(SplatMode::adaptive);
            const FrameReport report = draw_until_done(drawing, framebuffer, camera, map_offset, options);
            EXPECT_EQ(report.frames_averaged, 8u);
            framebuffer.clear();
            EXPECT_FALSE(drawing.draw(camera, map_offset, options).refining);
            drawing.release();
            return framebuffer.read();
        };
        const auto whole = drawn(large);
        EXPECT_GT(partly_covered(whole), 100u);
        std::size_t differ = 0;
        for (int tile = 0; tile < 4; ++tile) {
            Camera part = view;
            for (std::size_t c = 0; c < 4; ++c)
                for (std::size_t r = 0; r < 2; ++r) {
                    const double shift = (tile >> r & 1) ? -1 : 1;
                    double& entry = part.projection[c * 4 + r];
                    entry = 2 * entry + shift * view.projection[c * 4 + 3];
                }
            const auto pixels = drawn(part);
            for (int y = 0; y < high; ++y)
                for (int x = 0; x < wide; ++x) {
                    const Pixel& a = pixels[static_cast<std::size_t>(y * wide + x)];
                    const Pixel& b = whole[static_cast<std::size_t>((y + (tile & 2 ? high : 0)) * 2 * wide + x +
                                                                    (tile & 1 ? wide : 0))];
                    differ += !(a == b);
                }
        }
        // Rounding of places at the edges of splats.
        EXPECT_LT(differ, whole.size() / 200);
    }
}

// Near by, where the discs of a surface are wide, their colours pass into one another: red and blue points at random do
// not make a mosaic of red and blue. What is not a disc in a surface keeps its borders, and so does a picture without a
// mean.
TEST(Smoothing, WideDiscsPassIntoOneAnother)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto points = random_points(40000, 20000, 5);
    for (LasPoint& p : points) {
        p.x -= 10000, p.y -= 10000, p.z = 0;
        p.green = 0;
        p.red = p.intensity % 2 ? 65535 : 0;
        p.blue = p.intensity % 2 ? 0 : 65535;
    }
    const auto plane = make_cloud(folder, "plane", grid_at({0, 0, 0}), points);
    const Framebuffer framebuffer(wide, high);
    const auto view_at = [](double distance, bool parallel) {
        const Matrix projection =
            parallel ? orthographic(0.4 * distance, 0.3 * distance, 0.01, 100) : perspective(0.6, 4.0 / 3, 0.01, 100);
        return view_of(translation(0, 0, -distance), projection, wide, high);
    };
    // The share of the pixels that are neither red nor blue by more than an eighth.
    const auto share_mixed = [&](SplatMode mode, double distance, unsigned frames, bool parallel) {
        const Camera view = view_at(distance, parallel);
        Drawing drawing(plane);
        drawing.style = coloured(mode);
        draw_until_done(drawing, framebuffer, view, {0, 0, 0}, smooth(frames));
        const auto pixels = framebuffer.read();
        drawing.release();
        const auto mixed = std::count_if(pixels.begin(), pixels.end(),
                                         [](const Pixel& p) { return p.a == 255 && p.r > 32 && p.b > 32; });
        EXPECT_GT(std::count_if(pixels.begin(), pixels.end(), [](const Pixel& p) { return p.a == 255; }),
                  wide * high * 9 / 10);
        return static_cast<double>(mixed) / (wide * high);
    };
    for (const bool parallel : {false, true}) {
        // Splats 20 pixels across.
        const double near = 1.0;
        EXPECT_EQ(share_mixed(SplatMode::fitted, near, 1, parallel), 0);
        const double borders = share_mixed(SplatMode::adaptive, near, 8, parallel);
        EXPECT_LT(borders, 0.2);
        const double discs = share_mixed(SplatMode::fitted, near, 8, parallel);
        EXPECT_GT(discs, 2 * borders);
        EXPECT_EQ(share_mixed(SplatMode::fitted, near, 8, parallel), discs);  // the same each time
    }
}

// Far away, where discs are finer than pixels and overlap, a shift by a part of a pixel changes the picture less than
// it changes means of pictures without moved discs.
TEST(Smoothing, FarDiscsAreCalm)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto points = random_points(40000, 20000, 5);
    for (LasPoint& p : points) {
        p.x -= 10000, p.y -= 10000, p.z = 0;
        p.green = 0;
        p.red = p.intensity % 2 ? 65535 : 0;
        p.blue = p.intensity % 2 ? 0 : 65535;
    }
    const auto plane = make_cloud(folder, "plane", grid_at({0, 0, 0}), points);
    const Framebuffer framebuffer(wide, high);
    const Camera here = view_of(translation(0, 0, -50), perspective(0.6, 4.0 / 3, 0.01, 100), wide, high);
    const Camera there = shifted(here, {0.4, 0});
    Drawing drawing(plane);
    drawing.style = coloured(SplatMode::fitted);
    const auto unmoved = [&](const Camera& view) {
        return mean_of_pictures(drawing, framebuffer, view, {0, 0, 0}, smooth(1), 16);
    };
    const auto moved = [&](const Camera& view) {
        draw_until_done(drawing, framebuffer, view, {0, 0, 0}, smooth(16));
        return sums_of(framebuffer.read());
    };
    const double before = change_of(unmoved(here), unmoved(there)), now = change_of(moved(here), moved(there));
    EXPECT_LT(now, 0.97 * before) << before;
    drawing.release();
}
