// What a moving view draws when there is no time for it.
#include "tests/gl/gl_support.h"

#include "pcm/gl/tuning.h"

using namespace pcm;
using namespace pcm::test;

// The minimum number of points in view is drawn, each of them counted once, and no chunk more than needed.
TEST(MovingView, HasTheMinimumNumberOfPointsInViewHoweverSlowTheMachineIs)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const double least = gl_tuning().budget.min_points_in_view;
    constexpr std::uint32_t chunk_points = 1000;
    const auto cloud =
        make_cloud(folder, "sheet", grid_at(map_offset), sheet(300, [](std::int32_t) { return 0; }), chunk_points);
    ASSERT_GT(cloud->info().points, 4 * least);
    const Framebuffer framebuffer(160, 120);
    Drawing drawing(cloud);
    RenderOptions options;
    options.eye_dome = 0;
    options.target_spacing_px = 0;
    options.fill_gaps = false;
    options.frame_budget_ms = 1e-3;
    FrameReport report;
    for (int frame = 0; frame < 30; ++frame) {
        const Camera view =
            view_of(translation(-15 - 0.01 * frame, -15, 0), orthographic(24, 18, -10, 10), 160, 120);  // all of it
        framebuffer.clear();
        report = drawing.draw(view, map_offset, options);
        ASSERT_EQ(report.error, "");
        cloud->cache().wait_idle();
        if (frame < 20) continue;  // chunks are loaded, and their time is known
        EXPECT_GE(static_cast<double>(report.points_drawn), least) << "frame " << frame;
        EXPECT_LT(static_cast<double>(report.points_drawn), least + chunk_points) << "frame " << frame;
    }
    drawing.release();
}
