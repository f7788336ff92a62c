// When a picture is given up, with a clock of the test's own.

#include "pcm/cli/standstill.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <string>

namespace pcm::cli {
namespace {

// Looks every `step` seconds, for `seconds`, at what `change` makes of the progress. Returns the error, or nothing.
template <class Change>
std::string watched(double seconds, double step, Change change)
{
    Standstill standstill;
    DrawingProgress progress;
    progress.chunks_missing = 5;
    try {
        for (double t = 0; t <= seconds; t += step) {
            ++progress.frames;
            change(progress, t);
            standstill.look(progress, t);
        }
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::io);
        return error.what();
    }
    return "";
}

TEST(StandstillTest, WaitsWhileAnythingProgresses)
{
    const auto every = [](double seconds, auto DrawingProgress::*counter) {
        return [seconds, counter, last = 0.0](DrawingProgress& progress, double t) mutable {
            if (t - last < seconds) return;
            last = t;
            ++(progress.*counter);
        };
    };
    for (const auto counter :
         {&DrawingProgress::points_drawn, &DrawingProgress::uploaded_bytes, &DrawingProgress::loaded_bytes,
          &DrawingProgress::points_added, &DrawingProgress::chunks_missing})
        EXPECT_EQ(watched(20000, 0.25, every(500, counter)), "");
}

// The counters' sum stays, since one falls as another grows: that is progress.
TEST(StandstillTest, CountersAreNotAdded)
{
    EXPECT_EQ(watched(2000, 0.25,
                      [n = 0](DrawingProgress& progress, double) mutable {
                          progress.points_drawn = static_cast<std::uint64_t>(1000000 - ++n);
                          progress.loaded_bytes = static_cast<std::uint64_t>(n);
                      }),
              "");
}

TEST(StandstillTest, AFewLongFramesAreNoStandstill)
{
    EXPECT_EQ(watched(19 * 70, 70, [](DrawingProgress& progress, double) { progress.chunks_missing = 0; }), "");
}

// A resting view on a slow machine: what is shown stays, all chunks are loaded, and each frame adds to what comes next.
TEST(StandstillTest, AFrameInProgressIsProgress)
{
    EXPECT_EQ(watched(2000, 0.25,
                      [](DrawingProgress& progress, double) {
                          progress.chunks_missing = 0;
                          progress.points_added += 5000;
                      }),
              "");
}

TEST(StandstillTest, SaysTheTrueCause)
{
    const auto nothing = [](DrawingProgress&, double) {};
    EXPECT_EQ(watched(599, 0.25, nothing), "");
    const std::string reading = watched(700, 0.25, nothing);
    EXPECT_NE(reading.find("5 chunks have not arrived from the disk"), std::string::npos) << reading;
    EXPECT_EQ(reading.find("--l1"), std::string::npos) << reading;

    const auto refused = [](DrawingProgress& progress, double) { ++progress.refused; };
    EXPECT_EQ(watched(59, 0.25, refused), "");
    const std::string memory = watched(70, 0.25, refused);
    EXPECT_NE(memory.find("--l1"), std::string::npos) << memory;

    const std::string loaded =
        watched(70, 0.25, [](DrawingProgress& progress, double) { progress.chunks_missing = 0; });
    EXPECT_NE(loaded.find("all chunks are loaded"), std::string::npos) << loaded;
}

}  // namespace
}  // namespace pcm::cli
