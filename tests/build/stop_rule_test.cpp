#include "pcm/build/levels/stop_rule.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace pcm {
namespace {

using Bins = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  // points, and how many of them are chosen

bool reached(const Bins& bins)
{
    StopRule rule;
    for (const auto& [points, chosen] : bins) rule.see(points, chosen);
    return rule.reached();
}

TEST(StopRule, ATenthOfOneBin)
{
    EXPECT_TRUE(reached({{1000, 100}}));
    EXPECT_FALSE(reached({{1000, 99}}));
    EXPECT_TRUE(reached({{1000, 1000}}));
    EXPECT_FALSE(reached({{1000, 0}}));
    EXPECT_TRUE(reached({{10, 1}}));
    EXPECT_FALSE(reached({{11, 1}}));
    EXPECT_FALSE(reached({{1, 0}}));
    EXPECT_TRUE(reached({{1, 1}}));
    EXPECT_TRUE(reached({}));
}

// Powers of two, of which the mean is exact: 1/8 and 1/16 are 3 and 4 doublings.
TEST(StopRule, TheGeometricMeanOverAllPoints)
{
    EXPECT_TRUE(reached({{3 << 10, 3 << 7}, {1 << 10, 1 << 6}}));
    EXPECT_FALSE(reached({{3 << 10, 3 << 7}, {(1 << 10) + 16, (1 << 6) + 1}}));
    EXPECT_FALSE(reached({{1 << 10, 1 << 7}, {1 << 10, 1 << 6}}));
}

// A few per cent of the points ten thousand times as dense are not waited for, half of them are.
TEST(StopRule, AClump)
{
    EXPECT_TRUE(reached({{960'000, 200'000}, {40'000, 4}}));
    EXPECT_FALSE(reached({{500'000, 200'000}, {500'000, 50}}));
    EXPECT_TRUE(reached({{500'000, 500'000}, {500'000, 6'000}}));
}

}  // namespace
}  // namespace pcm
