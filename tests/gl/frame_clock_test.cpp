// Frames are timed, in order, with queries and by waiting.
#include "tests/gl/gl_support.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/draw/frame_clock.h"

#include <algorithm>
#include <chrono>
#include <thread>

using namespace pcm;
using namespace pcm::test;

TEST(FrameClock, KnowsFramesInTheirOrder)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const Framebuffer framebuffer(64, 64);
    for (const bool queries : {false, true}) {
        FrameClock clock(queries);
        EXPECT_EQ(clock.waits(), !queries);
        std::uint64_t last = 0, known = 0;
        for (std::uint64_t frame = 1; frame <= 50; ++frame) {
            clock.begin();
            framebuffer.clear();
            if (frame == 50) std::this_thread::sleep_for(std::chrono::milliseconds(30));
            clock.end({frame, frame, 0});
            if (frame % 10 == 0) glFinish();
            while (const auto measure =
                       clock.take()) {  // the device may finish another one meanwhile, but each frame is reported once
                ++known;
                EXPECT_GT(measure->work.points, last);
                EXPECT_LE(measure->work.points, frame);
                EXPECT_GE(measure->milliseconds, 0);
                EXPECT_LT(measure->milliseconds, 60000);
                last = measure->work.points;
                // A frame that the device has to wait for takes as long as it waits.
                if (last == 50) EXPECT_GE(measure->milliseconds, 30);
            }
        }
        EXPECT_GE(known, 5u);
        if (!queries) EXPECT_EQ(known, 50u);
        clock.release();
        EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
        clock.begin();  // and again from the start
        clock.end({1, 1, 0});
        glFinish();
        EXPECT_TRUE(clock.take());
        clock.release();
    }
}

// A clock that nobody asks has all of its queries in flight. Those frames become known at once; later ones are
// measured.
TEST(FrameClock, MeasuresAgainAfterAllQueriesWereInFlight)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const Framebuffer framebuffer(64, 64);
    FrameClock clock(true);
    std::uint64_t frame = 0;
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t first = frame + 1;
        for (int i = 0; i < 3 + round; ++i) {
            clock.begin();
            framebuffer.clear();
            clock.end({++frame, 2 * frame, 3});
        }
        glFinish();
        const auto measure = clock.take();
        ASSERT_TRUE(measure);
        // The first four of them were measured; of those the latest is known.
        EXPECT_EQ(measure->work.points, std::min(frame, first + 3));
        EXPECT_EQ(measure->work.vertices, 2 * measure->work.points);
        EXPECT_FALSE(clock.take());
    }
    clock.release();
}

// Software rasterisers' queries omit the vertex stage.
TEST(FrameClock, WaitsWhereTheDeviceIsTheProcessor)
{
    PCM_REQUIRE_GL(context, Profile::core);
    FrameClock clock;
    clock.begin();
    clock.end({1, 1, 0});
    EXPECT_EQ(clock.waits(), gl_is_software());
    clock.release();
}
