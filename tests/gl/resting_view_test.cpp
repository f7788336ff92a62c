// Adaptive splats from the moving to the resting view.
#include "pcm/gl/draw/frame.h"
#include "pcm/update/tree_changes.h"
#include "tests/gl/gl_support.h"

#include <algorithm>
#include <cmath>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr int wide = 160, high = 120;

Camera view_of_cube() { return view_of(overview(10), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high); }

CloudStyle adaptive()
{
    CloudStyle style;
    style.splats = SplatMode::adaptive;
    style.colour = ColourMode::rgb;
    return style;
}

// A plane of `count` random points, 100 x 100 units, around the origin.
std::vector<LasPoint> random_plane(std::size_t count)
{
    auto points = random_points(count, 100000, 5);
    for (LasPoint& p : points) p.x -= 50000, p.y -= 50000, p.z = 0;
    return points;
}

// The share of empty pixels among those whose rays meet the plane z = 0 more than five units inside of the square.
double share_of_holes(const std::vector<Pixel>& pixels, const Camera& view, double tilt, double distance)
{
    std::size_t holes = 0, inside = 0;
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            const double dx = ((x + 0.5) / view.width * 2 - 1) / view.projection[0],
                         dy = ((y + 0.5) / view.height * 2 - 1) / view.projection[5];
            // Back from the eye: the modelview is translation(0, 0, -distance) * rotation_x(-tilt).
            const double c = std::cos(tilt), s = std::sin(tilt);
            const double eye_y = -s * distance, eye_z = c * distance;
            const double ray_y = c * dy + s, ray_z = s * dy - c;
            if (ray_z >= 0) continue;
            const double t = -eye_z / ray_z;
            if (std::abs(t * dx) > 45 || std::abs(eye_y + t * ray_y) > 45) continue;
            ++inside;
            holes += pixels[static_cast<std::size_t>(y * view.width + x)].a == 0;
        }
    EXPECT_GT(inside, 2000u);
    return static_cast<double>(holes) / static_cast<double>(std::max<std::size_t>(inside, 1));
}

}  // namespace

TEST(RestingView, AdaptiveSplatsBecomeTheSamePictureWhateverTheBudgets)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(40000, 10000, 21), 1500);
    const Framebuffer framebuffer(wide, high);
    for (const Matrix& projection : {perspective(0.9, 4.0 / 3, 0.1, 1000), orthographic(4, 3, -100, 100)}) {
        const Camera view = view_of(overview(10), projection, wide, high);
        std::vector<Pixel> at_once;
        for (int way = 0; way < 4; ++way) {
            L1Options l1;
            l1.block_bytes = 1u << 20;
            if (way > 1) l1.capacity_bytes = 2u << 20;  // less than all points take
            Drawing drawing(cloud, l1);
            drawing.style = adaptive();
            RenderOptions options = everything();
            if (way > 0) {
                options.target_spacing_px = way == 2 ? 20 : 4;
                options.point_budget = way == 3 ? 5000 : 30000;
                options.upload_budget_ms = way == 1 ? 0 : 3;
                cloud->cache().clear();
            }
            FrameReport report;
            std::vector<std::vector<Pixel>> claimed;  // pictures that were reported as final
            int frames = 0;
            for (; frames < 5000; ++frames) {
                framebuffer.clear();
                report = drawing.draw(view, map_offset, options);
                ASSERT_EQ(report.error, "");
                if (report.full_resolution) claimed.push_back(framebuffer.read());
                if (!report.refining) break;
                if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            EXPECT_TRUE(report.full_resolution);
            EXPECT_EQ(report.points_drawn, projection[11] == 0 ? report.points_drawn : 40000u);
            const auto last = framebuffer.read();
            if (way == 0) at_once = last;
            EXPECT_TRUE(last == at_once) << "way " << way;
            for (const auto& picture : claimed) EXPECT_TRUE(picture == at_once) << "way " << way;
            // It stays.
            framebuffer.clear();
            report = drawing.draw(view, map_offset, options);
            EXPECT_TRUE(report.full_resolution && !report.refining && report.points_added == 0);
            EXPECT_TRUE(framebuffer.read() == at_once);
            drawing.release();
        }
        // At rest it is another picture than in a moving view.
        Drawing drawing(cloud);
        drawing.style = adaptive();
        RenderOptions options = everything();
        options.converge = false;
        const FrameReport report = draw_until_done(drawing, framebuffer, view, map_offset, options);
        EXPECT_TRUE(report.full_resolution);  // a view that never rests shows no more
        EXPECT_FALSE(framebuffer.read() == at_once);
        drawing.release();
        // Unless it was asked for.
        Drawing asked(cloud);
        asked.style = adaptive();
        options.paraboloids = true;
        EXPECT_TRUE(draw_until_done(asked, framebuffer, view, map_offset, options).full_resolution);
        EXPECT_TRUE(framebuffer.read() == at_once);
        asked.release();
    }
}

// However few points a moving view can draw in time, a resting one may draw all.
TEST(RestingView, IsAllowedTheWholeBudget)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "plane", grid_at({0, 0, 0}), random_plane(20000), 1500);
    const Framebuffer framebuffer(wide, high);
    Drawing drawing(cloud);
    drawing.style = adaptive();
    RenderOptions options = everything();
    options.target_spacing_px = 4;
    options.frame_budget_ms = 1e-3;
    Camera view;
    FrameReport report;
    for (int frame = 0; frame < 20; ++frame) {
        view = view_of(translation(0.01 * frame, 0, -40), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);
        framebuffer.clear();
        report = drawing.draw(view, {0, 0, 0}, options);
        ASSERT_EQ(report.error, "");
    }
    EXPECT_LT(report.effective_point_budget, options.point_budget);
    report = draw_until_done(drawing, framebuffer, view, {0, 0, 0}, options);
    EXPECT_TRUE(report.full_resolution);
    EXPECT_EQ(report.effective_point_budget, options.point_budget);
    drawing.release();
}

// While its splats are added a few at a time, the picture of the moving view stays, whose splats fill the gaps.
TEST(RestingView, APartOfItIsNotShown)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "plane", grid_at({0, 0, 0}), random_plane(40000), 1500);
    const Framebuffer framebuffer(wide, high);
    const Camera view =
        view_of(translation(0, 0, -40), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);  // all of it is plane
    Drawing drawing(cloud);
    drawing.style = adaptive();
    RenderOptions options = everything();
    options.target_spacing_px = 8;
    options.point_budget = 3000;
    std::size_t lit = 0;
    int frames = 0;
    for (FrameReport report; frames < 1000; ++frames) {
        framebuffer.clear();
        report = drawing.draw(view, {0, 0, 0}, options);
        ASSERT_EQ(report.error, "");
        const std::size_t now = count_lit(framebuffer.read());
        // The sizes of a moving view change as its chunks come: by 2 % at most, seen on a busy machine.
        EXPECT_GE(now, lit * 95 / 100) << "frame " << frames;
        lit = std::max(lit, now);
        if (!report.refining) break;
        if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_GT(frames, 3);
    EXPECT_GT(lit, wide * high * 99u / 100);
    drawing.release();
}

TEST(RestingView, WithoutPointsItEnds)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(3000, 10000, 22));
    const Framebuffer framebuffer(wide, high);
    Drawing drawing(cloud);
    drawing.style = adaptive();
    const Camera away =
        view_of(translation(0, 0, 500), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);  // the cloud is behind
    const FrameReport report = draw_until_done(drawing, framebuffer, away, map_offset, everything());
    EXPECT_EQ(report.points_drawn, 0u);
    EXPECT_TRUE(report.full_resolution);
    EXPECT_EQ(count_lit(framebuffer.read()), 0u);
    drawing.release();
}

// Colours that change with detail allow no resting view: the moving one is then the final picture.
TEST(RestingView, WithoutOneTheMovingViewIsFinal)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(3000, 10000, 22));
    const Framebuffer framebuffer(wide, high);
    Drawing drawing(cloud);
    drawing.style = adaptive();
    drawing.style.colour = ColourMode::error;
    const Camera view = view_of(overview(10), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);
    const FrameReport report = draw_until_done(drawing, framebuffer, view, map_offset, everything());
    EXPECT_EQ(report.points_drawn, 3000u);
    EXPECT_TRUE(report.full_resolution);
    drawing.release();
}

// A closed surface is closed, at any distance and tilt, moving and at rest. That the test can fail, squares of two
// pixels show.
TEST(RestingView, AClosedSurfaceHasNoHoles)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "plane", grid_at({0, 0, 0}), random_plane(40000));
    const Framebuffer framebuffer(wide, high);
    for (const double tilt : {0.0, 0.7, 1.3})
        for (const double distance : {100.0, 40.0, 15.0}) {
            const Camera view = view_of(product(translation(0, 0, -distance), rotation_x(-tilt)),
                                        perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);
            const auto holes = [&](SplatMode mode, bool rest) {
                Drawing drawing(cloud);
                drawing.style = adaptive();
                drawing.style.splats = mode;
                RenderOptions options = everything();
                options.converge = rest;
                draw_until_done(drawing, framebuffer, view, {0, 0, 0}, options);
                const auto pixels = framebuffer.read();
                drawing.release();
                return share_of_holes(pixels, view, tilt, distance);
            };
            SCOPED_TRACE(testing::Message() << "tilt " << tilt << ", distance " << distance);
            const double moving = holes(SplatMode::adaptive, false), resting = holes(SplatMode::adaptive, true);
            const double constant = holes(SplatMode::constant, true);
            EXPECT_LT(moving, 0.001);
            EXPECT_LT(resting, 0.001);
            if (distance < 50 && tilt < 1) EXPECT_GT(constant, 0.1);
        }
}

// A tree that was built before sizes were kept is drawn too, with the spacing of its points.
TEST(RestingView, ATreeWithoutSizesIsClosedToo)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    make_cloud(folder, "plane", grid_at({0, 0, 0}), random_plane(40000));
    {
        TreeChanges changes(folder / "plane.pct");
        for (NodeId id = 0; id < changes.tree()->nodes().size(); ++id)
            if (changes.tree()->node(id).points > 0)
                changes.write(id, changes.read(id, ColumnSet::all(changes.tree()->info().schema)), {});
        changes.commit();
    }
    Drawing drawing(PointCloud::open(folder / "plane.pct"));
    drawing.style = adaptive();
    const Framebuffer framebuffer(wide, high);
    const Camera view = view_of(translation(0, 0, -40), perspective(0.9, 4.0 / 3, 0.1, 1000), wide, high);
    draw_until_done(drawing, framebuffer, view, {0, 0, 0}, everything());
    EXPECT_LT(share_of_holes(framebuffer.read(), view, 0, 40), 0.02);
    drawing.release();
}

// What a frame of a resting view costs says nothing about moving views.
TEST(RestingView, ItsFramesAreMeasuredApart)
{
    PCM_REQUIRE_GL(context, Profile::core);
    PictureState picture;
    picture.unmeasured = 0;
    picture.target.prepare(wide, high, 1);
    picture.target.bind();
    const RenderOptions options;
    L1Cache l1;
    SplatPass splats;
    const auto draw = [&](bool at_rest) {
        Frame frame{picture, options, l1, splats};
        frame.at_rest = at_rest;
        timed(frame, [&](Strokes&) {
            frame.work = {1000, 1000, 1000, 4000};
            picture.target.clear();
            glFinish();
        });
        EXPECT_EQ(&frame.costs(), at_rest ? &picture.rest_budget : &picture.budget);
    };
    // The time of a frame is known one or a few later.
    for (int i = 0; i < 10; ++i) draw(true);
    EXPECT_EQ(picture.budget.last_measured_ms(), 0);
    EXPECT_GT(picture.rest_budget.last_measured_ms(), 0);
    const double at_rest = picture.rest_budget.last_measured_ms();
    picture.clock.release();
    for (int i = 0; i < 10; ++i) draw(false);
    EXPECT_GT(picture.budget.last_measured_ms(), 0);
    EXPECT_EQ(picture.rest_budget.last_measured_ms(), at_rest);
    picture.clock.release();
    picture.target.release();
    splats.release();
    l1.release();
}
