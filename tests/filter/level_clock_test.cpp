#include "pcm/filter/level_clock.h"

#include <gtest/gtest.h>

namespace {

using pcm::LevelClock;

// Each level takes four times as long as the one before, plus 1 for what all levels take.
const std::vector<double> costs{1 + 1, 1 + 4, 1 + 16, 1 + 64};

// Runs ten units one after the other; a unit at level l takes seconds_per_cost * costs[l].
struct Pass {
    std::vector<std::size_t> levels;
    double seconds = 0;
};
Pass run(LevelClock& clock, double seconds_per_cost, std::size_t slow_from = 0)
{
    Pass run;
    for (std::size_t unit = 0; unit < 10; ++unit) {
        run.levels.push_back(clock.next(run.seconds, double(unit) / 10, 10));
        run.seconds += costs[run.levels.back()] * (unit < slow_from ? 1 : seconds_per_cost);
    }
    return run;
}

TEST(LevelClock, StaysWithTheFirstLevelWhileThereIsTime)
{
    LevelClock clock(costs, 2, 171);  // 10 units of 17
    EXPECT_EQ(run(clock, 1).levels, std::vector<std::size_t>(10, 2));
    EXPECT_EQ(clock.coarser_units(), 0u);
    EXPECT_EQ(clock.coarsest(), 2u);
    EXPECT_EQ(clock.units(), 10u);
}

TEST(LevelClock, EndsInTimeWhereItIsSlowerThanPredicted)
{
    for (const double slower : {1.3, 2.0, 4.0}) {
        LevelClock clock(costs, 3, 651);
        const Pass done = run(clock, slower);
        EXPECT_LE(done.seconds, 651) << slower;
        EXPECT_GT(done.seconds, 400) << slower << ": coarser than it had to be";
        EXPECT_EQ(done.levels.front(), 3u);
        EXPECT_GT(clock.coarser_units(), 0u);
        EXPECT_LT(clock.coarsest(), 3u);
    }
    LevelClock late(costs, 3, 651);
    EXPECT_LE(run(late, 3, 6).seconds, 1.1 * 651) << "slow from the seventh unit on";
}

TEST(LevelClock, GoesOnAtTheCoarsestLevelWhenTheTimeIsOver)
{
    LevelClock clock(costs, 3, 10);
    const Pass done = run(clock, 1);
    EXPECT_EQ(done.levels.front(), 3u);  // nothing is known yet
    EXPECT_EQ(done.levels[1], 0u);
    EXPECT_EQ(done.levels.back(), 0u);
    EXPECT_EQ(clock.coarser_units(), 9u);
    LevelClock none(costs, 3, -1);
    EXPECT_EQ(none.next(0, 0, 10), 0u);
}

TEST(LevelClock, CountsHalfOfWhatOtherThreadsAreDoing)
{
    // Eight units were begun at once, at 65 each; after 65 seconds four of them are done: four under way.
    LevelClock clock(costs, 3, 66);
    for (int i = 0; i < 8; ++i) clock.next(0, 0, 10);
    // Six of ten units are as good as done, those under way end by themselves, two are left: too many at any speed.
    EXPECT_EQ(clock.next(65, 0.4, 10), 0u);
    LevelClock longer(costs, 3, 200);
    for (int i = 0; i < 8; ++i) longer.next(0, 0, 10);
    EXPECT_EQ(longer.next(65, 0.4, 10), 3u);
}

}  // namespace
