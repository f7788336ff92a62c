// Pictures of moving and of resting views.
#include "tests/gl/gl_support.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>

using namespace pcm;
using namespace pcm::test;

// For any budgets and caches, a resting view converges to the picture of all points, pixel for pixel, and that equals a
// z-buffer in double.
TEST(Picture, ARestingViewBecomesTheFullResolutionPicture)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto points = random_points(60000, 10000, 21);
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), points, 1500);
    const Framebuffer framebuffer(160, 120);
    for (const Matrix& projection : {perspective(0.9, 4.0 / 3, 0.1, 1000), orthographic(4, 3, -100, 100)}) {
        const Camera view = view_of(overview(10), projection, 160, 120);
        std::vector<Pixel> at_once;
        {
            Drawing drawing(cloud);
            drawing.style.colour = ColourMode::rgb;
            const FrameReport report = draw_until_done(drawing, framebuffer, view, map_offset, everything());
            EXPECT_TRUE(report.full_resolution);
            at_once = framebuffer.read();
            drawing.release();
        }
        for (int way = 0; way < 3; ++way) {
            L1Options l1;
            l1.block_bytes = 1u << 20;
            if (way > 0) l1.capacity_bytes = 1u << 20;  // room for a third of the points
            Drawing drawing(cloud, l1);
            drawing.style.colour = ColourMode::rgb;
            RenderOptions options;
            options.eye_dome = 0;
            options.target_spacing_px = way == 1 ? 20 : 4;
            options.frame_budget_ms = 1e9;
            options.point_budget = way == 2 ? 5000 : 30000;
            options.upload_budget_ms = way == 0 ? 0 : 3;
            cloud->cache().clear();
            std::uint64_t before = 0;
            FrameReport report;
            int frames = 0;
            for (; frames < 5000; ++frames) {
                framebuffer.clear();
                report = drawing.draw(view, map_offset, options);
                ASSERT_EQ(report.error, "");
                EXPECT_LE(report.points_added, options.point_budget);
                EXPECT_GE(report.points_drawn, before);
                before = report.points_drawn;
                if (!report.refining) break;
                if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            EXPECT_GT(frames, 2);
            EXPECT_TRUE(report.full_resolution);
            EXPECT_EQ(report.screen_error_px, 0);
            EXPECT_TRUE(framebuffer.read() == at_once) << "way " << way;
            // From now on only the finished picture is composited.
            framebuffer.clear();
            report = drawing.draw(view, map_offset, options);
            EXPECT_EQ(report.points_added, 0u);
            EXPECT_TRUE(report.full_resolution);
            EXPECT_FALSE(report.refining);
            EXPECT_TRUE(framebuffer.read() == at_once);
            drawing.release();
        }

        // Squares of two pixels; pixels where edges or depths are too close to decide are left out.
        struct Nearest {
            double depth = 2, second = 2;
            const LasPoint* point = nullptr;
            bool unsure = false;
        };
        std::vector<Nearest> buffer(160 * 120);
        for (const LasPoint& p : points) {
            const double local[4] = {p.x * 0.001, p.y * 0.001, p.z * 0.001, 1};
            double eye[4] = {}, clip[4] = {};
            for (std::size_t r = 0; r < 4; ++r)
                for (std::size_t c = 0; c < 4; ++c) eye[r] += view.modelview[c * 4 + r] * local[c];
            for (std::size_t r = 0; r < 4; ++r)
                for (std::size_t c = 0; c < 4; ++c) clip[r] += projection[c * 4 + r] * eye[c];
            if (std::max({std::abs(clip[0]), std::abs(clip[1]), std::abs(clip[2])}) > clip[3]) continue;
            const double x = (clip[0] / clip[3] + 1) * 80, y = (clip[1] / clip[3] + 1) * 60, depth = clip[2] / clip[3];
            for (int py = static_cast<int>(y) - 2; py <= static_cast<int>(y) + 2; ++py)
                for (int px = static_cast<int>(x) - 2; px <= static_cast<int>(x) + 2; ++px) {
                    if (px < 0 || py < 0 || px >= 160 || py >= 120) continue;
                    Nearest& at = buffer[static_cast<std::size_t>(py * 160 + px)];
                    const double away = std::max(std::abs(px + 0.5 - x), std::abs(py + 0.5 - y));
                    if (away > 1 + 1.0 / 128) continue;
                    if (away > 1 - 1.0 / 128) {
                        if (depth < at.depth + 1e-6) at.unsure = true;
                        continue;
                    }
                    if (depth < at.depth) {
                        at.second = at.depth;
                        at.depth = depth;
                        at.point = &p;
                    } else {
                        at.second = std::min(at.second, depth);
                    }
                }
        }
        std::size_t compared = 0, wrong = 0;
        for (std::size_t i = 0; i < buffer.size(); ++i) {
            const Nearest& at = buffer[i];
            if (at.unsure || (at.point && at.second - at.depth < 1e-5)) continue;
            ++compared;
            const auto byte = [](std::uint16_t v) { return static_cast<int>(v * 255.0 / 65535 + 0.5); };
            const Pixel& p = at_once[i];
            if (!at.point)
                wrong += p.a != 0;
            else
                wrong += p.a != 255 || std::abs(p.r - byte(at.point->red)) > 1 ||
                         std::abs(p.g - byte(at.point->green)) > 1 || std::abs(p.b - byte(at.point->blue)) > 1;
        }
        EXPECT_GT(compared, 5000u);
        EXPECT_EQ(wrong, 0u);
    }
}

// The limit of uploads keeps moving views smooth: a resting view uploads as long as its frames may take.
TEST(Picture, ARestingViewUsesTheTimeOfItsFrames)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(60000, 10000, 22), 1500);
    const auto& all = cloud->tree()->nodes();
    const auto nodes = static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [](const Node& node) { return node.points > 0; }));
    ASSERT_GT(nodes, 40u);
    const Framebuffer framebuffer(160, 120);
    const Camera view = view_of(overview(10), perspective(0.9, 4.0 / 3, 0.1, 1000), 160, 120);
    for (const bool converge : {false, true}) {
        cloud->cache().clear();
        Drawing drawing(cloud);
        RenderOptions options = everything();
        options.upload_budget_ms = 0;  // one chunk per frame
        options.converge = converge;
        std::size_t frames = 1;
        FrameReport report = drawing.draw(view, map_offset, options);
        while (report.refining && frames < 10 * nodes) {
            cloud->cache().wait_idle();
            report = drawing.draw(view, map_offset, options);
            ++frames;
        }
        EXPECT_FALSE(report.refining);
        EXPECT_EQ(report.points_drawn, 60000u);
        if (converge)
            EXPECT_LT(frames, nodes / 2);
        else
            EXPECT_GE(frames, nodes);
        drawing.release();
    }
}

// Under one budget, the nodes with the largest errors are drawn first, of whichever tree; each tree may be placed
// anywhere.
TEST(Picture, SeveralCloudsShareABudgetByScreenError)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto near_cloud = make_cloud(folder, "near", grid_at(map_offset), random_points(40000, 10000, 31), 1000);
    const auto far_cloud = make_cloud(folder, "far", grid_at({0, 0, 0}), random_points(40000, 10000, 32), 1000);
    const auto l1 = std::make_shared<L1Cache>();
    Renderer renderer(l1);
    DrawnCloud a(near_cloud, l1), b(far_cloud, l1);
    Picture picture;
    const Framebuffer framebuffer(200, 100);
    SceneItem near_item, far_item;
    near_item.cloud = &a;
    near_item.origin = map_offset;
    near_item.placement = translation(-12, -5, 0);
    far_item.cloud = &b;
    far_item.placement = translation(20, -5, -80);
    const Camera view = view_of(translation(0, 0, -20), perspective(0.9, 2, 0.1, 1000), 200, 100);
    RenderOptions options;
    options.eye_dome = 0;
    options.frame_budget_ms = 1e9;
    options.target_spacing_px = 0.1;
    options.point_budget = 30000;
    options.upload_budget_ms = 1000;
    options.converge = false;
    const auto until_done = [&](const std::vector<SceneItem>& items) {
        FrameReport report;
        for (int frame = 0; frame < 3000; ++frame) {
            framebuffer.clear();
            report = renderer.draw(picture, view, items, options);
            EXPECT_EQ(report.error, "");
            if (!report.refining) return report;
            if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        ADD_FAILURE() << "still refining";
        return report;
    };
    FrameReport report = until_done({near_item, far_item});
    ASSERT_EQ(report.clouds.size(), 2u);
    EXPECT_LE(report.points_drawn, 30000u);
    EXPECT_EQ(report.points_drawn, report.clouds[0].points_drawn + report.clouds[1].points_drawn);
    EXPECT_GT(report.clouds[0].points_drawn, 3 * report.clouds[1].points_drawn);
    EXPECT_GT(report.clouds[1].points_drawn, 0u);
    const std::uint64_t near_points = report.clouds[0].points_drawn;
    // The nearer tree alone has the whole budget.
    report = until_done({near_item});
    EXPECT_GT(report.clouds[0].points_drawn, near_points);
    // Both trees are complete in the end, at their two places.
    options.converge = true;
    report = until_done({near_item, far_item});
    EXPECT_TRUE(report.full_resolution);
    EXPECT_EQ(report.points_drawn, 80000u);
    const auto pixels = framebuffer.read();
    std::size_t left = 0, right = 0;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 200; ++x) (x < 100 ? left : right) += pixels[static_cast<std::size_t>(y * 200 + x)].a > 0;
    EXPECT_GT(left, 500u);
    EXPECT_GT(right, 50u);
    EXPECT_LT(right, left / 4);
    picture.release();
    renderer.release();
    a.release();
    b.release();
    l1->release();
}

// One cloud in two places is loaded once.
// Not under the address sanitizer: much drawing in software.
TEST(Picture, PCM_NOT_UNDER_ADDRESS(ACloudMayBeShownTwice))
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(30000, 10000, 33), 1000);
    const auto l1 = std::make_shared<L1Cache>();
    Renderer renderer(l1);
    DrawnCloud drawn(cloud, l1);
    Picture picture;
    const Framebuffer framebuffer(200, 100);
    SceneItem left, right;
    left.cloud = right.cloud = &drawn;
    left.origin = right.origin = map_offset;
    left.placement = translation(-12, -5, 0);
    right.placement = translation(2, -5, 0);
    right.style.colour = ColourMode::height;
    const Camera view = view_of(translation(0, 0, -30), perspective(0.9, 2, 0.1, 1000), 200, 100);
    for (const bool moving : {true, false}) {
        RenderOptions options = everything();
        options.converge = !moving;
        FrameReport report;
        for (int frame = 0; frame < 3000; ++frame) {
            framebuffer.clear();
            report = renderer.draw(picture, view, {left, right}, options);
            ASSERT_EQ(report.error, "");
            if (!report.refining) break;
            if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        EXPECT_FALSE(report.refining);
        EXPECT_EQ(report.points_drawn, 60000u);
    }
    const auto& nodes = cloud->tree()->nodes();
    EXPECT_EQ(l1->statistics().compulsory_misses,
              static_cast<std::uint64_t>(
                  std::count_if(nodes.begin(), nodes.end(), [](const Node& node) { return node.points > 0; })));
    const auto pixels = framebuffer.read();
    std::size_t lit[2] = {};
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 200; ++x) lit[x >= 100] += pixels[static_cast<std::size_t>(y * 200 + x)].a > 0;
    EXPECT_GT(lit[0], 500u);
    EXPECT_GT(lit[1], 500u);
    // Colours of two attributes, or another cache, are refused with an error, and nothing is drawn.
    right.style.colour = ColourMode::intensity;
    EXPECT_NE(renderer.draw(picture, view, {left, right}, everything()).error, "");
    DrawnCloud stranger(cloud, std::make_shared<L1Cache>());
    right.cloud = &stranger;
    EXPECT_NE(renderer.draw(picture, view, {left, right}, everything()).error, "");
    right.cloud = nullptr;
    EXPECT_NE(renderer.draw(picture, view, {left, right}, everything()).error, "");
    picture.release();
    renderer.release();
    drawn.release();
    l1->release();
}

// A flight through a cloud with an L1 far too small for it: no part of the cloud is ever blank.
TEST(Picture, AMovingViewIsNeverBlankWhereThereArePoints)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    auto points = sheet(400, [](std::int32_t x) { return x % 40 < 20 ? 0 : 400; });
    const auto cloud = make_cloud(folder, "sheet", grid_at(map_offset), points, 2000);
    L1Options l1;
    l1.block_bytes = 1u << 20;
    l1.capacity_bytes = 1u << 20;
    Drawing drawing(cloud, l1);
    drawing.style.point_size_px = 3;
    const Framebuffer framebuffer(160, 120);
    RenderOptions options;
    options.eye_dome = 0;
    options.frame_budget_ms = 1e9;
    options.point_budget = 25000;
    for (int frame = 0; frame < 120; ++frame) {
        const double along = 4 + 0.5 * (frame < 60 ? frame : 119 - frame);  // there and back
        const Camera view = view_of(product(rotation_x(-0.6), translation(-along, -12, -6)),
                                    perspective(0.9, 4.0 / 3, 0.1, 200), 160, 120);
        framebuffer.clear();
        const FrameReport report = drawing.draw(view, map_offset, options);
        ASSERT_EQ(report.error, "");
        cloud->cache().wait_idle();
        if (frame == 0) {  // the first picture may be empty
            draw_until_done(drawing, framebuffer, view, map_offset, options);
            continue;
        }
        EXPECT_LE(report.points_drawn, 25000u);
        // Tiles well inside the sheet.
        const auto pixels = framebuffer.read();
        std::size_t blank = 0, tiles = 0;
        for (int ty = 0; ty < 120; ty += 20)
            for (int tx = 0; tx < 160; tx += 20) {
                bool inside = true;
                for (const auto& [dx, dy] : {std::pair{0, 0}, {20, 0}, {0, 20}, {20, 20}}) {
                    // The ray of this corner, intersected with z = 0.
                    const double ndc[2] = {(tx + dx) / 80.0 - 1, (ty + dy) / 60.0 - 1};
                    const double d[3] = {ndc[0] / view.projection[0], ndc[1] / view.projection[5], -1};
                    const double c = std::cos(0.6), s = std::sin(0.6);  // back by rotation_x(0.6)
                    const double world[3] = {d[0], c * d[1] - s * d[2], s * d[1] + c * d[2]};
                    const double t = -6 / world[2];
                    inside = inside && t > 0 && along + t * world[0] > 1 && along + t * world[0] < 38.5 &&
                             12 + t * world[1] > 1 && 12 + t * world[1] < 38.5;
                }
                if (!inside) continue;
                ++tiles;
                std::size_t lit = 0;
                for (int y = 0; y < 20; ++y)
                    for (int x = 0; x < 20; ++x) lit += pixels[static_cast<std::size_t>((ty + y) * 160 + tx + x)].a > 0;
                blank += lit == 0;
            }
        EXPECT_GT(tiles, 4u);
        EXPECT_EQ(blank, 0u) << "frame " << frame;
    }
    EXPECT_GT(drawing.l1()->statistics().capacity_misses, 0u);
    drawing.release();
}

// A coarse picture has no holes where the full one has none: splats grow to fill the gaps. At rest they shrink, and no
// frame in between shows less of the surface.
TEST(Picture, CoarsePicturesHaveNoHoles)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud =
        make_cloud(folder, "sheet", grid_at(map_offset), sheet(400, [](std::int32_t) { return 0; }), 2000);
    const Framebuffer framebuffer(160, 120);
    const Camera view =
        view_of(product(rotation_x(-0.5), translation(-20, -15, -10)), perspective(0.9, 4.0 / 3, 0.1, 200), 160, 120);
    const auto holes = [&](const std::vector<Pixel>& picture, const std::vector<Pixel>& full) {
        std::size_t covered = 0, missing = 0;
        for (std::size_t i = 0; i < full.size(); ++i) {
            covered += full[i].a > 0;
            missing += full[i].a > 0 && picture[i].a == 0;
        }
        EXPECT_GT(covered, 5000u);
        return static_cast<double>(missing) / static_cast<double>(covered);
    };
    Drawing reference(cloud);
    draw_until_done(reference, framebuffer, view, map_offset, everything());
    const auto full = framebuffer.read();
    reference.release();

    double share[2];
    for (const bool fill : {false, true}) {
        Drawing drawing(cloud);
        RenderOptions options = everything();
        options.point_budget = 8000;
        options.fill_gaps = fill;
        options.converge = false;
        const FrameReport coarse = draw_until_done(drawing, framebuffer, view, map_offset, options);
        EXPECT_LT(coarse.points_drawn, 8001u);
        share[fill] = holes(framebuffer.read(), full);
        if (fill) {
            options.converge = true;
            options.upload_budget_ms = 0;
            FrameReport report;
            for (int frame = 0; frame < 5000; ++frame) {
                framebuffer.clear();
                report = drawing.draw(view, map_offset, options);
                ASSERT_EQ(report.error, "");
                EXPECT_LT(holes(framebuffer.read(), full), 0.03) << "frame " << frame;
                if (!report.refining) break;
                if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            EXPECT_TRUE(report.full_resolution);
            EXPECT_TRUE(framebuffer.read() == full);
        }
        drawing.release();
    }
    EXPECT_GT(share[0], 0.2);
    EXPECT_LT(share[1], 0.03);
}

// The budget that a slow machine has learnt in a wide view is too small for a narrow one, in which few points of the
// coarse chunks are: it is raised until enough points are in view.
TEST(Picture, ABudgetLearntInAWideViewDoesNotEmptyANarrowOne)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud =
        make_cloud(folder, "sheet", grid_at(map_offset), sheet(500, [](std::int32_t) { return 0; }), 5000);
    const Framebuffer framebuffer(160, 120);
    Drawing drawing(cloud), reference(cloud);
    RenderOptions options;
    options.eye_dome = 0;
    options.target_spacing_px = 0;
    options.fill_gaps = false;
    options.frame_budget_ms = 1e-3;
    std::uint64_t learnt = 0;
    for (int frame = 0; frame < 40; ++frame) {
        const bool narrow = frame >= 30;
        // Around the middle, which the chunks of all levels are cut at.
        const Camera view =
            narrow ? view_of(translation(-25 - 0.02 * frame, -25, 0), orthographic(2.7, 2, -10, 10), 160, 120)
                   : view_of(translation(-25 - 0.02 * frame, -25, 0), orthographic(30, 25, -10, 10), 160, 120);
        framebuffer.clear();
        const FrameReport report = drawing.draw(view, map_offset, options);
        ASSERT_EQ(report.error, "");
        cloud->cache().wait_idle();
        const std::size_t moving = count_lit(framebuffer.read());
        if (!narrow) learnt = report.effective_point_budget;
        if (frame < 34) continue;  // chunks are loaded
        EXPECT_GT(report.effective_point_budget, learnt);
        draw_until_done(reference, framebuffer, view, map_offset, everything());
        EXPECT_EQ(moving, count_lit(framebuffer.read())) << "frame " << frame;
    }
    EXPECT_LT(learnt, 40'000u);
    drawing.release();
    reference.release();
}

// On a machine that has no time left for points, a view of a small part of a cloud has its points while it moves: not
// the few of the coarsest chunk that happen to be there.
TEST(Picture, AMovingViewOfAPartHasItsPointsHoweverSlowTheMachineIs)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud =
        make_cloud(folder, "sheet", grid_at(map_offset), sheet(500, [](std::int32_t) { return 0; }), 12000);
    const Framebuffer framebuffer(160, 120);
    Drawing drawing(cloud), reference(cloud);
    RenderOptions options;
    options.eye_dome = 0;
    options.fill_gaps = false;
    options.frame_budget_ms = 1e-3;
    std::size_t seen_at_least = ~std::size_t(0);
    for (int frame = 0; frame < 40; ++frame) {
        // 5 of 50 units, from above: some 2000 of the 250,000 points.
        // Before that all of it, of which a few points are enough.
        const bool part = frame >= 15;
        const Camera view =
            part ? view_of(translation(-20 - 0.05 * frame, -20, 0), orthographic(2.7, 2, -10, 10), 160, 120)
                 : view_of(translation(-25 - 0.05 * frame, -25, 0), orthographic(30, 25, -10, 10), 160, 120);
        framebuffer.clear();
        const FrameReport report = drawing.draw(view, map_offset, options);
        ASSERT_EQ(report.error, "");
        cloud->cache().wait_idle();
        const std::size_t moving = count_lit(framebuffer.read());
        if (frame < 20) continue;  // chunks are loaded
        draw_until_done(reference, framebuffer, view, map_offset, everything());
        const std::size_t all = count_lit(framebuffer.read());
        EXPECT_GT(all, 4000u);
        EXPECT_EQ(moving, all) << "frame " << frame;
        seen_at_least = std::min(seen_at_least, moving);
        EXPECT_LT(report.points_drawn, 100'000u) << "the others are not drawn";
    }
    EXPECT_GT(seen_at_least, 4000u);
    drawing.release();
    reference.release();
}
