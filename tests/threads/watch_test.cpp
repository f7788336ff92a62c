#include "pcm/threads/watch.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

namespace {

using namespace pcm;

struct Seen {
    std::string stage;
    double fraction;
    double seconds_left;
};

TEST(Watch, ReportsAtMostTenTimesASecondAndNeverBackwards)
{
    std::vector<Seen> seen;
    const ProgressFunction progress = [&](const ProgressUpdate& update) {
        seen.push_back({std::string(update.stage), update.fraction, update.seconds_left});
        return true;
    };
    Watch watch(progress);
    for (int i = 0; i < 1000; ++i) watch.report("first", 0.001 * i);
    const double loop_seconds = watch.seconds();
    EXPECT_LE(seen.size(), static_cast<std::size_t>(10 * loop_seconds) + 1);

    seen.clear();
    watch.report("at once", 0.5, true);
    watch.report("smaller", 0.25, true);
    watch.report("too large", 7, true);
    ASSERT_EQ(seen.size(), 3u);
    EXPECT_EQ(seen[0].stage, "at once");
    EXPECT_EQ(seen[0].fraction, 0.5);
    EXPECT_GE(seen[0].seconds_left, 0);
    EXPECT_EQ(seen[1].fraction, 0.5);
    EXPECT_EQ(seen[2].fraction, 1);
}

TEST(Watch, TimeThatPassedLetsTheNextReportThrough)
{
    int calls = 0;
    const ProgressFunction progress = [&](const ProgressUpdate&) { return ++calls, true; };
    Watch watch(progress);
    watch.report("now", 0.1);
    EXPECT_EQ(calls, 0);  // less than a tenth of a second has passed
    std::this_thread::sleep_for(std::chrono::milliseconds(120));
    watch.report("now", 0.1);
    EXPECT_EQ(calls, 1);
    watch.report("done", 1);  // the end is always reported
    EXPECT_EQ(calls, 2);
}

TEST(Watch, CancelThrowsButNotAfterTheEnd)
{
    const ProgressFunction refuse = [](const ProgressUpdate&) { return false; };
    Watch watch(refuse);
    try {
        watch.report("stage", 0.5, true);
        FAIL() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
    EXPECT_NO_THROW(watch.finish("stage"));
}

TEST(Watch, WorksWithoutAProgressFunction)
{
    const ProgressFunction nobody;
    Watch watch(nobody);
    watch.report("stage", 0.5, true);
    watch.finish("stage");
    EXPECT_GE(watch.seconds(), 0);
}

}  // namespace
