// Cuts against counting: both sides have points, about a third at least, and the order of the points does not matter.

#include "pcm/build/bins/cut.h"

#include "pcm/build/bins/top_tree.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>

namespace pcm {
namespace {

template <class Coord>
using Cloud = std::vector<std::array<Coord, 3>>;

template <class Coord>
std::optional<Cut<Coord>> cut_of(const Cloud<Coord>& cloud, const AxisShift& finer = {0, 0, 0})
{
    return choose_cut<Coord>(cloud.size(), finer, [&](std::size_t i, std::size_t axis) { return cloud[i][axis]; });
}

template <class Coord>
class Cuts : public testing::Test {
public:
    static constexpr Coord largest = std::numeric_limits<Coord>::max();
    std::mt19937_64 random{5};
    Coord number() { return static_cast<Coord>(random()); }

    Cloud<Coord> cloud(const std::string& kind, std::size_t count)
    {
        Cloud<Coord> points(count);
        for (std::size_t i = 0; i < count; ++i) {
            auto& p = points[i];
            if (kind == "full range") p = {number(), number(), number()};
            if (kind == "ends") p = {random() % 2 ? largest : Coord(0), Coord(0), largest};
            if (kind == "neighbours") p = {largest, static_cast<Coord>(largest - random() % 2), largest};
            if (kind == "few values")
                p = {static_cast<Coord>(random() % 7), static_cast<Coord>(random() % 3), Coord(5)};
            if (kind == "pile and outliers")  // most in one place, some far away on one side
                p = random() % 10 ? std::array<Coord, 3>{1000, 2, 3} : std::array<Coord, 3>{number(), 2, 3};
            if (kind == "dense far below")
                p = {random() % 4 ? static_cast<Coord>(random() % 64) : number(), Coord(0), Coord(0)};
            if (kind == "dense in the middle")
                p = {random() % 4 ? static_cast<Coord>(largest / 3 + random() % 64) : number(), Coord(0), Coord(0)};
            if (kind == "dense far above")
                p = {random() % 4 ? static_cast<Coord>(largest - random() % 64) : number(), Coord(0), Coord(0)};
            if (kind == "ascending") p = {static_cast<Coord>(i), Coord(9), Coord(9)};
        }
        return points;
    }
};
using Widths = testing::Types<std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(Cuts, Widths);

TYPED_TEST(Cuts, PartThePointsEvenly)
{
    using Coord = TypeParam;
    for (const std::string kind : {"full range", "ends", "neighbours", "few values", "pile and outliers",
                                   "dense far below", "dense in the middle", "dense far above", "ascending"})
        for (const std::size_t count : {2u, 3u, 5u, 64u, 1000u, 5000u})
            for (int trial = 0; trial < 5; ++trial) {
                SCOPED_TRACE(kind + ", " + std::to_string(count));
                auto cloud = this->cloud(kind, count);
                const auto cut = cut_of(cloud);
                const bool all_same = std::all_of(cloud.begin(), cloud.end(), [&](auto& p) { return p == cloud[0]; });
                ASSERT_EQ(cut.has_value(), !all_same);
                if (!cut) continue;
                std::size_t left = 0;
                std::map<Coord, std::size_t> values;
                std::array<Coord, 3> low = cloud[0], high = cloud[0];
                for (const auto& p : cloud) {
                    left += p[cut->axis] < cut->value;
                    ++values[p[cut->axis]];
                    for (std::size_t a = 0; a < 3; ++a) {
                        low[a] = std::min(low[a], p[a]);
                        high[a] = std::max(high[a], p[a]);
                    }
                }
                ASSERT_GT(left, 0u);
                ASSERT_LT(left, count);
                for (std::size_t a = 0; a < 3; ++a) ASSERT_GE(high[cut->axis] - low[cut->axis], high[a] - low[a]);
                std::size_t most_alike = 0;
                for (const auto& value : values) most_alike = std::max(most_alike, value.second);
                if (most_alike * 3 <= count) {
                    ASSERT_GE(left * 3, count);
                    ASSERT_GE((count - left) * 3, count);
                }
                std::shuffle(cloud.begin(), cloud.end(), this->random);
                const auto again = cut_of(cloud);
                ASSERT_EQ(again->axis, cut->axis);
                ASSERT_EQ(again->value, cut->value);
            }
}

TYPED_TEST(Cuts, AreAtRoundNumbersNearTheMedian)
{
    Cloud<TypeParam> cloud;
    for (TypeParam i = 0; i < 1000; ++i) cloud.push_back({static_cast<TypeParam>(i + 30), 0, 0});
    EXPECT_EQ(cut_of(cloud)->value, 512u);  // the value in 480 .. 580 with the largest number of zeros at its end
    for (auto& p : cloud) p[0] += 65536 - 530;
    EXPECT_EQ(cut_of(cloud)->value, 65536u);
}

TYPED_TEST(Cuts, MeasureLengthsOnTheCoarsestGrid)
{
    Cloud<TypeParam> cloud;
    for (TypeParam i = 0; i < 100; ++i)
        cloud.push_back({static_cast<TypeParam>(i), static_cast<TypeParam>(300 * i), static_cast<TypeParam>(7 * i)});
    EXPECT_EQ(cut_of(cloud)->axis, 1u);
    EXPECT_EQ(cut_of(cloud, {0, 9, 0})->axis, 2u);  // y counts in 512ths
    EXPECT_EQ(cut_of(cloud, {0, 9, 3})->axis, 0u);
}

TEST(AxisShift, IsTheBinaryLogarithmOfTheRatio)
{
    EXPECT_EQ(axis_shift(Grid{{1, 1, 1}, {0, 0, 0}}), (AxisShift{0, 0, 0}));
    EXPECT_EQ(axis_shift(Grid{{0.001, 0.001, 0.0006}, {0, 0, 0}}), (AxisShift{0, 0, 0}));
    EXPECT_EQ(axis_shift(Grid{{1, 0.25, 1.0 / 64}, {0, 0, 0}}), (AxisShift{0, 2, 6}));
    EXPECT_EQ(axis_shift(Grid{{1e-8, 1e-8, 1.7664e-9}, {0, 0, 0}}), (AxisShift{0, 0, 2}));
}

// The grid over the tree is a short cut alone: every place is in the bin that a walk from the root finds.
TYPED_TEST(Cuts, OfATreeLeadToOneBinFromTheRootAndFromTheGrid)
{
    using Coord = TypeParam;
    for (const std::string kind : {"full range", "few values", "pile and outliers", "dense far below", "ascending"}) {
        SCOPED_TRACE(kind);
        auto sample = this->cloud(kind, 3000);
        const auto cloud = sample;
        TopTree<Coord> top;
        const std::size_t bins = TopPlanner<Coord>(top, AxisShift{0, 0, 0}, 100).plan(0, sample, 6000, 0);
        ASSERT_FALSE(top.starts.empty());
        std::vector<std::size_t> points(bins, 0);
        for (const auto& p : cloud) ++points.at(top.bin_of(p));
        if (kind == "full range" || kind == "ascending") {  // 50 of the sample stand for 100 points
            for (const std::size_t n : points) EXPECT_LE(n, 50u);
            EXPECT_GE(bins, 60u);
        }
        for (int trial = 0; trial < 20000; ++trial) {
            std::array<Coord, 3> p = trial % 3 ? cloud[this->random() % cloud.size()]
                                               : std::array<Coord, 3>{this->number(), this->number(), this->number()};
            if (trial % 5 == 0) p[this->random() % 3] = trial % 2 ? this->largest : Coord(0);
            if (trial % 7 == 0) p[0] += static_cast<Coord>(this->random() % 3 - 1);
            ASSERT_EQ(top.bin_of(p), top.bin_of(p, 0));
        }
    }
}

}  // namespace
}  // namespace pcm
