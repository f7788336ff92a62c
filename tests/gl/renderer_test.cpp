// Loading and refining: what the pictures of small trees hold while chunks arrive, and when video memory is short.
#include "tests/gl/gl_support.h"

#include "pcm/build/builder.h"
#include "pcm/tree/tree_index.h"
#include "pcm/view/level_of_detail.h"

#include <atomic>
#include <fstream>

using namespace pcm;
using namespace pcm::test;

class RendererIn : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, RendererIn, testing::Values(Profile::compatibility, Profile::core),
                         [](const auto& info) { return info.param == Profile::core ? "Core" : "Compatibility"; });

// Chunks that a moving view will see are loaded ahead; none are when prefetching is off.
TEST_P(RendererIn, AMovingViewLoadsAhead)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto cloud_file = make_cloud(folder, "cube", grid_at(map_offset), random_points(40000, 100000, 3), 1000);
    const Framebuffer framebuffer(320, 240);
    for (const bool ahead : {true, false}) {
        const auto cloud = PointCloud::open(cloud_file->tree()->folder());
        Drawing renderer(cloud);
        RenderOptions options = everything();
        options.prefetch_frames = ahead ? 8 : 0;
        const auto camera_at = [&](double x) {
            return view_of(product(translation(-x, -50, -160), translation(0, 0, 0)),
                           perspective(0.25, 4.0 / 3, 0.1, 1000), 320, 240);
        };
        draw_until_done(renderer, framebuffer, camera_at(20), map_offset, options);
        for (double x = 21; x <= 24; ++x) {
            for (int frame = 0; frame < 20; ++frame) {  // all of this view, then the chunks ahead
                renderer.draw(camera_at(x + frame * 1e-9), map_offset, options);
                cloud->cache().wait_idle();
            }
            renderer.draw(camera_at(x + 0.5), map_offset, options);
            cloud->cache().wait_idle();
        }
        // The view after eight frames of half a metre.
        const Camera later = camera_at(24.5 + 8 * 0.5);
        Camera view = later;
        view.origin = map_offset;
        DetailLimits limits;
        limits.target_px = 0;
        std::size_t seen = 0, there = 0;
        for (const DetailNode& node : select_detail(*cloud->tree(), view, limits).wanted) {
            ++seen;
            there += static_cast<bool>(cloud->cache().find(node.node, ColumnSet::only_positions()));
        }
        EXPECT_GT(seen, 5u);
        if (ahead)
            EXPECT_EQ(there, seen);
        else
            EXPECT_LT(there, seen);
    }
}

TEST(Renderer, RefinesWithoutEverShowingLess)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto points = random_points(120000, 10000, 5);
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), points, 2000);
    ASSERT_GT(cloud->tree()->nodes().size(), 60u);  // more than one window of requests
    std::atomic<int> wakes{0};
    for (const double target : {0.0, 3.0}) {
        Drawing renderer(cloud);
        renderer.set_wake([&] { ++wakes; });
        cloud->cache().clear();
        const Framebuffer framebuffer(200, 200);
        const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 200, 200);
        RenderOptions options = everything();
        options.target_spacing_px = target;
        options.converge = false;
        options.fill_gaps = false;
        options.upload_budget_ms = 0;  // one chunk per frame
        FrameReport last;
        last.screen_error_px = 1e9;
        std::size_t lit = 0;
        int frames = 0;
        for (;; ++frames) {
            ASSERT_LT(frames, 20000);
            framebuffer.clear();
            const FrameReport report = renderer.draw(camera, map_offset, options);
            ASSERT_EQ(report.error, "");
            EXPECT_LE(report.screen_error_px, last.screen_error_px);
            EXPECT_GE(report.points_drawn, last.points_drawn);
            EXPECT_LE(report.nodes_drawn, last.nodes_drawn + 2 + static_cast<unsigned>(frames));
            EXPECT_EQ(report.nodes_missing > 0 || report.repaint, report.refining);
            if (frames < 50 || frames % 20 == 0) {
                const std::size_t now = count_lit(framebuffer.read());
                EXPECT_GE(now, lit);
                lit = now;
            }
            last = report;
            if (!report.refining) break;
            if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        EXPECT_LE(last.screen_error_px, target);
        EXPECT_EQ(last.nodes_missing, 0u);
        EXPECT_EQ(last.nodes_drawn, last.nodes_wanted);
        if (target == 0) EXPECT_EQ(last.points_drawn, points.size());
        if (target > 0) EXPECT_LT(last.points_drawn, points.size());
        const L1Statistics s = renderer.l1()->statistics();
        EXPECT_EQ(s.compulsory_misses, last.nodes_drawn);
        EXPECT_EQ(s.capacity_misses, 0u);
        EXPECT_EQ(s.uploaded_bytes, last.points_drawn * 12);  // no colours were needed, none were uploaded
        renderer.release();
    }
    EXPECT_GT(wakes, 0);
}

TEST(Renderer, ChangingTheColourShowsEveryPointAllTheTime)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(30000, 10000, 6), 2000);
    Drawing renderer(cloud);
    const Framebuffer framebuffer(100, 100);
    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    RenderOptions options = everything();
    draw_until_done(renderer, framebuffer, camera, map_offset, options);
    const std::size_t lit = count_lit(framebuffer.read());
    options.upload_budget_ms = 0;
    for (const ColourMode mode : {ColourMode::rgb, ColourMode::intensity, ColourMode::height, ColourMode::rgb}) {
        renderer.style.colour = mode;
        for (int frame = 0;; ++frame) {
            ASSERT_LT(frame, 5000);
            framebuffer.clear();
            const FrameReport report = renderer.draw(camera, map_offset, options);
            ASSERT_EQ(report.points_drawn, 30000u);
            ASSERT_EQ(count_lit(framebuffer.read()), lit);
            if (!report.refining) break;
            if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    renderer.release();
}

TEST(Renderer, ColoursAreTheCloudsOwn)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    // Four points far apart, looked at straight down, 1 unit per pixel.
    std::vector<LasPoint> points(4);
    const std::uint16_t bytes[4][3] = {{255, 0, 10}, {1, 128, 254}, {77, 200, 0}, {0, 0, 33}};
    const Camera camera = view_of(identity(), product(translation(-1, -1, 0), orthographic(20, 20, -10, 10)), 40, 40);
    for (const bool eight_bit : {false, true}) {
        for (std::size_t i = 0; i < 4; ++i) {
            points[i].x = static_cast<std::int32_t>(5500 + 8000 * i);
            points[i].y = 20500;
            points[i].z = static_cast<std::int32_t>(i);
            const int factor = eight_bit ? 1 : 257;
            points[i].red = static_cast<std::uint16_t>(bytes[i][0] * factor);
            points[i].green = static_cast<std::uint16_t>(bytes[i][1] * factor);
            points[i].blue = static_cast<std::uint16_t>(bytes[i][2] * factor);
            points[i].intensity = static_cast<std::uint16_t>(1000 + 100 * i);
        }
        Drawing renderer(make_cloud(folder, eight_bit ? "eight" : "sixteen", grid_at({0, 0, 0}), points));
        const Framebuffer framebuffer(40, 40);
        RenderOptions options = everything();
        renderer.style.point_size_px = 1;
        renderer.style.colour = ColourMode::rgb;
        draw_until_done(renderer, framebuffer, camera, {0, 0, 0}, options);
        auto pixels = framebuffer.read();
        EXPECT_EQ(count_lit(pixels), 4u);
        for (std::size_t i = 0; i < 4; ++i) {
            const Pixel p = pixels[20 * 40 + 5 + 8 * i];
            EXPECT_EQ(p.r, bytes[i][0]);
            EXPECT_EQ(p.g, bytes[i][1]);
            EXPECT_EQ(p.b, bytes[i][2]);
        }
        // Dark colours made lighter; what is neutral is exact, and ramps stay what their legend says.
        for (const auto& [brightness, gamma] : {std::pair(2.0f, 1.0f), {1.0f, 2.0f}, {0.5f, 0.5f}, {1.0f, 1.0f}}) {
            renderer.style.brightness = brightness;
            renderer.style.gamma = gamma;
            draw_until_done(renderer, framebuffer, camera, {0, 0, 0}, options);
            pixels = framebuffer.read();
            for (std::size_t i = 0; i < 4; ++i) {
                const Pixel p = pixels[20 * 40 + 5 + 8 * i];
                const auto toned = [&, b = brightness, g = gamma](std::uint16_t byte) {
                    return 255 * std::pow(std::min(1.0, byte / 255.0 * double(b)), 1 / double(g));
                };
                EXPECT_NEAR(p.r, toned(bytes[i][0]), 0.75);
                EXPECT_NEAR(p.g, toned(bytes[i][1]), 0.75);
                EXPECT_NEAR(p.b, toned(bytes[i][2]), 0.75);
            }
        }
        EXPECT_EQ(pixels[20 * 40 + 13].g, 128);
        renderer.style.colour = ColourMode::height;
        draw_until_done(renderer, framebuffer, camera, {0, 0, 0}, options);
        const auto ramp = framebuffer.read();
        renderer.style.brightness = renderer.style.gamma = 3;
        draw_until_done(renderer, framebuffer, camera, {0, 0, 0}, options);
        EXPECT_TRUE(framebuffer.read() == ramp);
        for (const ColourMode mode : {ColourMode::intensity, ColourMode::height}) {
            renderer.style.colour = mode;
            draw_until_done(renderer, framebuffer, camera, {0, 0, 0}, options);
            pixels = framebuffer.read();
            int before = -1;
            for (std::size_t i = 0; i < 4; ++i) {  // both increase from point to point
                const Pixel p = pixels[20 * 40 + 5 + 8 * i];
                EXPECT_GT(p.r + 2 * p.g, before);
                before = p.r + 2 * p.g;
            }
        }
        renderer.release();
    }
}

// Video memory for a third of the points in view: a moving view shows what fits, a resting one everything.
TEST(Renderer, LivesWithLittleVideoMemory)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(300000, 10000, 7), 4000);
    L1Options l1;
    l1.block_bytes = 1u << 20;
    l1.capacity_bytes = 2u << 20;  // 34 pages; the cloud needs more than 75
    Drawing renderer(cloud, l1);
    const Framebuffer framebuffer(100, 100);
    RenderOptions options = everything();
    renderer.style.colour = ColourMode::rgb;
    for (const bool converge : {false, true}) {
        options.converge = converge;
        for (int step = 0; step < 6; ++step) {
            const Camera view =
                view_of(product(translation(0, 0, 2 * step), overview(10)), perspective(0.9, 1, 0.1, 1000), 100, 100);
            const FrameReport report = draw_until_done(renderer, framebuffer, view, map_offset, options);
            EXPECT_GT(report.points_drawn, 20000u);
            EXPECT_EQ(report.nodes_missing, 0u);
            EXPECT_EQ(report.full_resolution, converge);
            EXPECT_EQ(report.screen_error_px == 0, converge);
            EXPECT_LE(renderer.l1()->statistics().allocated_bytes, l1.capacity_bytes);
        }
    }
    renderer.release();
}

TEST(Renderer, TwoCloudsShareOneCache)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto shared = std::make_shared<L1Cache>();
    Drawing a(make_cloud(folder, "a", grid_at(map_offset), random_points(20000, 10000, 8), 2000), shared);
    Drawing b(make_cloud(folder, "b", grid_at(map_offset), random_points(10000, 10000, 9), 2000), shared);
    const Framebuffer framebuffer(100, 100);
    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    EXPECT_EQ(draw_until_done(a, framebuffer, camera, map_offset, everything()).points_drawn, 20000u);
    EXPECT_EQ(draw_until_done(b, framebuffer, camera, map_offset, everything()).points_drawn, 10000u);
    const std::uint64_t both = shared->statistics().resident_chunks;
    a.release();
    EXPECT_LT(shared->statistics().resident_chunks, both);
    EXPECT_EQ(b.draw(camera, map_offset, everything()).points_drawn, 10000u);
    EXPECT_EQ(draw_until_done(a, framebuffer, camera, map_offset, everything()).points_drawn, 20000u);
    a.release();
    b.release();
    EXPECT_EQ(shared->statistics().resident_chunks, 0u);
    shared->release();
    EXPECT_EQ(shared->statistics().allocated_bytes, 0u);
}

// Matrices that are not those of a view, after a view: what that showed is not drawn by its matrices.
TEST(Renderer, MatricesOfNoViewShowNothing)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    Drawing drawing(make_cloud(folder, "a", grid_at(map_offset), random_points(5000, 10000, 12), 2000));
    const Framebuffer framebuffer(100, 100);
    const Camera view = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    EXPECT_EQ(draw_until_done(drawing, framebuffer, view, map_offset, everything()).points_drawn, 5000u);
    ASSERT_GT(count_lit(framebuffer.read()), 100u);
    Camera none = view;
    none.projection.fill(0);
    framebuffer.clear();
    EXPECT_EQ(drawing.draw(none, map_offset, everything()).points_drawn, 0u);
    EXPECT_EQ(count_lit(framebuffer.read()), 0u);
    drawing.release();
}

TEST(Renderer, ABrokenChunkIsReportedAndTheRestDrawn)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(30000, 10000, 11), 2000);
    const Node broken = cloud->tree()->nodes().back();
    {
        std::fstream file(cloud->tree()->folder() / data_file_name(broken.extent.file),
                          std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(broken.extent.offset + broken.extent.header_bytes + 8));
        // The positions come first; a damaged column that is not read would do no harm.
        const std::string junk(16, '\x55');
        file.write(junk.data(), 16);
    }
    Drawing renderer(cloud);
    const Framebuffer framebuffer(100, 100);
    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    RenderOptions options = everything();
    renderer.style.colour = ColourMode::rgb;
    FrameReport report;
    for (int frame = 0; frame < 3000; ++frame) {
        report = renderer.draw(camera, map_offset, options);
        if (!report.refining) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_FALSE(report.refining);
    EXPECT_NE(report.error.find("pcmlab repair " + cloud->tree()->folder().string()), std::string::npos)
        << report.error;
    EXPECT_EQ(report.nodes_missing, 1u);
    EXPECT_GT(report.screen_error_px, 0);
    EXPECT_EQ(report.points_drawn, 30000u - broken.points);
    renderer.release();
}
