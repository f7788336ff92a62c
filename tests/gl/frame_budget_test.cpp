#include "pcm/gl/draw/frame_budget.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

using namespace pcm;

namespace {

FrameWork work(std::uint64_t points)
{
    return {points, points, static_cast<double>(points), 4 * static_cast<double>(points)};
}

// One frame as the renderer runs it, for a view with `visible` points on a device where work takes `cost`: chosen
// within the allowed points, cut to the available time, drawn, and measured. Returns its time.
template <class Cost>
double frame(FrameBudget& budget, const Cost& cost, double budget_ms, std::uint64_t visible,
             std::uint64_t ceiling = 1'000'000'000)
{
    std::uint64_t points = std::min(budget.points(0, ceiling), visible);
    const double available = budget.available(budget_ms);
    if (budget.expected(work(points)) <= available) {
        budget.all(work(points), available / budget.expected(work(points)));
    } else {
        points = static_cast<std::uint64_t>(static_cast<double>(points) * available / budget.expected(work(points)));
        budget.fewer(points);
    }
    const double ms = cost(work(points));
    budget.measured(work(points), ms);
    return ms;
}

template <class Cost>
double settle(FrameBudget& budget, const Cost& cost, double budget_ms, int frames)
{
    double ms = 0;
    for (int i = 0; i < frames; ++i) ms = frame(budget, cost, budget_ms, 1'000'000'000);
    return ms;
}

auto cost_of_points(double each)
{
    return [each](const FrameWork& w) { return each * static_cast<double>(w.points); };
}

}  // namespace

TEST(FrameBudget, SettlesBelowTheAskedTimeOnFastAndSlowDevices)
{
    for (const double cost : {1e-7, 1e-6, 1e-5, 1e-4}) {
        FrameBudget budget;
        const double ms = settle(budget, cost_of_points(cost), 33, 300);
        EXPECT_LT(ms, 33) << "ms a point " << cost;
        EXPECT_GT(ms, 0.65 * 33) << "ms a point " << cost;
    }
}

// Time that a frame needs in addition to its points is reserved.
// Who draws until a target is reached draws another frame then.
TEST(FrameBudget, AFirstFrameOfEnoughPointsIsToBeMeasured)
{
    FrameBudget budget;
    EXPECT_FALSE(budget.is_to_be_measured(work(100)));  // too few to learn from
    budget.measured(work(100), 1);
    EXPECT_TRUE(budget.is_to_be_measured(work(100'000)));
    budget.measured(work(100'000), 1);
    EXPECT_FALSE(budget.is_to_be_measured(work(100'000)));
    budget.forget();
    EXPECT_TRUE(budget.is_to_be_measured(work(100'000)));
}

TEST(FrameBudget, LeavesRoomForTheRestOfTheFrame)
{
    FrameBudget budget;
    double ms = 0;
    for (int i = 0; i < 100; ++i) {
        ms = frame(budget, cost_of_points(1e-5), 33, 1'000'000'000);
        budget.measured_overhead(12);
    }
    EXPECT_LT(12 + ms, 33);
    EXPECT_GT(12 + ms, 22);
    for (int i = 0; i < 10; ++i) budget.measured_overhead(100);
    EXPECT_EQ(budget.available(33), 0);
}

TEST(FrameBudget, StaysPutOnceSettledAndFollowsAChange)
{
    FrameBudget budget;
    settle(budget, cost_of_points(1e-5), 33, 100);
    std::uint64_t most = 0, least = ~std::uint64_t(0);
    for (int i = 0; i < 100; ++i) {  // 4 % noise
        frame(budget, cost_of_points(i % 2 ? 1.02e-5 : 0.98e-5), 33, 1'000'000'000);
        const std::uint64_t points = budget.points(0, 1'000'000'000);
        most = std::max(most, points);
        least = std::min(least, points);
    }
    EXPECT_LT(static_cast<double>(most), 1.25 * static_cast<double>(least));
    EXPECT_NEAR(settle(budget, cost_of_points(5e-5), 33, 200), 27, 6);
    EXPECT_NEAR(settle(budget, cost_of_points(1e-5), 33, 200), 27, 6);
}

// After views of all kinds it predicts the cost of the next one, whichever stage is the device's slowest.
TEST(FrameBudget, PredictsWhatAnotherViewCosts)
{
    std::mt19937 random(6);
    std::uniform_real_distribution<double> share(0.02, 1), size(1, 60), noise(0.95, 1.05);
    for (const auto& [vertex, splat, pixel] :
         {std::array<double, 3>{1e-5, 2e-4, 3e-6}, {5e-4, 1e-5, 1e-6}, {1e-6, 1e-6, 2e-5}, {1e-8, 2e-8, 1e-8}}) {
        FrameBudget budget;
        const auto next = [&] {
            const auto points = static_cast<std::uint64_t>(2e4 + 5e5 * share(random));
            const double seen = share(random) * static_cast<double>(points);
            return FrameWork{points, points * (share(random) > 0.7 ? 4 : 1), seen, seen * size(random)};
        };
        const auto cost = [&, v = vertex, s = splat, p = pixel](const FrameWork& w) {
            return v * static_cast<double>(w.vertices) + s * w.splats + p * w.pixels;
        };
        for (int i = 0; i < 200; ++i) {
            const FrameWork w = next();
            budget.measured(w, cost(w) * noise(random));
        }
        double sum = 0;
        for (int i = 0; i < 200; ++i) {
            const FrameWork w = next();
            sum += std::abs(std::log(budget.expected(w) / cost(w)));
        }
        EXPECT_LT(sum / 200, 0.08) << vertex << ' ' << splat << ' ' << pixel;
    }
}

// A single delayed frame does not reduce the points of later frames.
TEST(FrameBudget, ASingleSlowFrameIsForgotten)
{
    FrameBudget budget;
    settle(budget, cost_of_points(1e-5), 33, 100);
    const double before = budget.expected(work(1'000'000));
    budget.measured(work(1'000'000), 500);
    EXPECT_LT(budget.expected(work(1'000'000)), 1.5 * before);
    settle(budget, cost_of_points(1e-5), 33, 20);
    EXPECT_NEAR(budget.expected(work(1'000'000)), before, 0.1 * before);
}

// One frame in a hundred takes half as long again: these keep to the budget too.
TEST(FrameBudget, LeavesAMarginForTheSlowFrames)
{
    FrameBudget budget;
    int slow = 0, over = 0;
    for (int i = 0; i < 3000; ++i) {
        const double factor = i % 60 == 59 ? 1.5 : 1;
        const double ms = frame(budget, cost_of_points(1e-5 * factor), 33, 1'000'000'000) + 2;
        budget.measured_overhead(2);
        if (i < 500) continue;
        slow += factor > 1;
        over += ms > 33;
    }
    EXPECT_GT(slow, 30);
    EXPECT_LT(over, 10);
}

// The margin, read from the time that is available: its first value, its steps, its bounds.
TEST(FrameBudget, TheMarginIsLearntWithinItsBounds)
{
    FrameBudget budget;
    const auto margin = [&] { return 33 / budget.available(33); };
    const auto next = [&](double milliseconds) {
        budget.measured(work(1'000'000), milliseconds);
        budget.measured_overhead(0);
    };
    next(10);
    EXPECT_DOUBLE_EQ(margin(), gl_tuning().late.first_margin);
    next(10);
    next(10);
    EXPECT_DOUBLE_EQ(margin(), gl_tuning().late.first_margin);  // too few frames to learn from
    double expected = gl_tuning().late.first_margin;
    for (int i = 0; i < 7; ++i) {
        next(10);
        EXPECT_NEAR(margin(), expected *= 0.9985, 1e-9);
    }
    // A frame counts once, however often the rest of it is measured.
    budget.measured_overhead(0);
    EXPECT_NEAR(margin(), expected, 1e-9);
    // Just beyond the margin, and just within.
    next(10 * 1.24);
    EXPECT_NEAR(margin(), expected *= 1.25, 1e-9);
    next(1.5 * budget.expected(work(1'000'000)));
    EXPECT_NEAR(margin(), expected *= 0.9985, 1e-9);
    for (double slow = 100; slow < 1e7; slow *= 10) next(slow);
    EXPECT_DOUBLE_EQ(margin(), gl_tuning().late.max_margin);
    for (int i = 0; i < 2000; ++i) next(10);
    EXPECT_NEAR(margin(), 1.05, 1e-9);
}

// The compared time includes all of the frame, not its drawing alone.
TEST(FrameBudget, TheMarginIsOfTheWholeFrame)
{
    FrameBudget budget;
    for (int i = 0; i < 4; ++i) {
        budget.measured(work(1'000'000), 10);
        budget.measured_overhead(10);
    }
    const double before = budget.available(33);
    budget.measured(work(1'000'000), 14);  // 40 % more drawing, which is 20 % of the frame
    budget.measured_overhead(10);
    EXPECT_GT(budget.available(33), before);
}

TEST(FrameBudget, KeepsTheNumberOfPointsWhenTheStyleChanges)
{
    FrameBudget budget;
    settle(budget, cost_of_points(1e-4), 33, 100);
    const std::uint64_t before = budget.points(0, 1'000'000'000);
    budget.forget();
    EXPECT_EQ(budget.points(0, 1'000'000'000), before);
    EXPECT_EQ(budget.expected(work(before)), 0);
    frame(budget, cost_of_points(1e-3), 33, 1'000'000'000);
    EXPECT_LT(frame(budget, cost_of_points(1e-3), 33, 1'000'000'000), 33);
}

TEST(FrameBudget, ARestingViewHasTheBudgetAndAtLeastTheOverhead)
{
    for (const auto& [overhead, time] : {std::pair{0.0, 33.0}, {10.0, 23.0}, {30.0, 30.0}, {200.0, 50.0}}) {
        FrameBudget budget;
        if (overhead > 0) budget.measured_overhead(overhead);
        EXPECT_EQ(budget.at_rest(33), time) << overhead;
    }
}

TEST(FrameBudget, KeepsItsBounds)
{
    FrameBudget budget;
    EXPECT_EQ(budget.available(33), std::numeric_limits<double>::infinity());
    EXPECT_EQ(budget.expected(work(1'000'000)), 0);
    for (int i = 0; i < 10; ++i) frame(budget, cost_of_points(1), 33, 1'000'000'000);
    EXPECT_EQ(budget.points(0, 1'000'000'000), gl_tuning().budget.min_points);
    EXPECT_EQ(budget.points(250'000, 1'000'000'000), 250'000u);  // the coarsest chunk is always drawn
    EXPECT_EQ(budget.points(250'000, 5'000), 5'000u);            // but the user's limit wins
    EXPECT_FALSE(budget.can_grow(5'000));
    EXPECT_EQ(budget.points(0, 0), 0u);
    std::uint64_t before = budget.points(0, 50'000'000);
    for (int i = 0; i < 400; ++i) {
        frame(budget, cost_of_points(1e-9), 33, 1'000'000'000, 50'000'000);
        const std::uint64_t now = budget.points(0, 50'000'000);
        EXPECT_LE(now, std::max<std::uint64_t>(20'000, 3 * before));
        before = now;
    }
    EXPECT_EQ(before, 50'000'000u);
    EXPECT_FALSE(budget.can_grow(50'000'000));
    frame(budget, cost_of_points(1e-9), std::numeric_limits<double>::infinity(),
          1'000'000'000);  // no time limit at all
    EXPECT_EQ(budget.points(0, 60'000'000), 60'000'000u);
}
