// Points drawn at random from those that are streamed past.

#include "pcm/detect/drawn_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm;

Vec3d point(std::uint64_t number) { return {static_cast<double>(number), 0, 0}; }

TEST(DrawnPoints, AllOfFewAndAsManyAsWereAskedForOfMany)
{
    for (const std::uint64_t count : {0, 1, 40, 41, 5000}) {
        DrawnPoints drawn(40);
        for (std::uint64_t i = 0; i < count; ++i) drawn.add(point(i), i);
        std::vector<Vec3d> points = drawn.points();
        ASSERT_EQ(points.size(), std::min<std::uint64_t>(40, count));
        std::sort(points.begin(), points.end());
        EXPECT_EQ(std::adjacent_find(points.begin(), points.end()), points.end()) << "a point was drawn twice";
    }
    DrawnPoints none(0);
    none.add(point(1), 1);
    EXPECT_TRUE(none.points().empty());
}

TEST(DrawnPoints, NeitherOrderNorPartsChangeThem)
{
    DrawnPoints forward(100), backward(100), even(100), odd(100);
    for (std::uint64_t i = 0; i < 3000; ++i) {
        forward.add(point(i), i);
        backward.add(point(2999 - i), 2999 - i);
        (i % 2 == 0 ? even : odd).add(point(i), i);
    }
    odd.add(even);
    EXPECT_EQ(forward.points(), backward.points());
    EXPECT_EQ(forward.points(), odd.points());
}

// Numbers are in sequence, as those of a node's points are. 200 draws take 100 from 2000: each tenth is to have 2000,
// and the standard deviation is 41.
TEST(DrawnPoints, EachIsAsProbable)
{
    std::array<int, 10> tenths{};
    for (std::uint64_t draw = 0; draw < 200; ++draw) {
        DrawnPoints drawn(100);
        for (std::uint64_t i = 0; i < 2000; ++i) drawn.add(point(i), (draw << 32) + i);
        for (const Vec3d& p : drawn.points()) ++tenths[static_cast<std::size_t>(p[0] / 200)];
    }
    for (const int count : tenths) EXPECT_NEAR(count, 2000, 165);
}

}  // namespace
