#include "pcm/build/levels/bin_neighbours.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace pcm {
namespace {

template <class Coord>
class Neighbours : public testing::Test {
protected:
    // `count` bins of one or two points in a box of `room` steps, each `width` steps wide at most; every seventh is
    // empty.
    void make(std::size_t count, Coord low, Coord room, Coord width, std::uint64_t seed)
    {
        std::mt19937_64 random(seed);
        store_.resize(count);
        for (std::size_t bin = 0; bin < count; ++bin) {
            if (bin % 7 == 3) continue;
            std::vector<Point<Coord>> points(1 + random() % 2);
            for (std::size_t a = 0; a < 3; ++a) {
                points[0][a] = static_cast<Coord>(low + static_cast<Coord>(random() % room));
                points.back()[a] = static_cast<Coord>(points[0][a] + static_cast<Coord>(random() % width));
            }
            store_.put(bin, points);
        }
    }
    // By comparing all bins with all others.
    typename BinNeighbours<Coord>::Lists one_by_one(const BinNeighbours<Coord>& neighbours, double spacing) const
    {
        typename BinNeighbours<Coord>::Lists lists(store_.bins());
        for (std::uint32_t bin = 0; bin < store_.bins(); ++bin)
            for (std::uint32_t other = 0; other < store_.bins(); ++other)
                if (bin != other && store_.box(bin).points && store_.box(other).points &&
                    neighbours.between(bin, other) * (1 - distance_margin) < spacing * spacing)
                    lists[bin].push_back(other);
        return lists;
    }

    const test::TemporaryFolder folder_;
    SortedPoints<Coord> store_{folder_ / "points"};
};
using Widths = testing::Types<std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(Neighbours, Widths);

TYPED_TEST(Neighbours, AreThoseFoundOneByOne)
{
    const auto far = static_cast<TypeParam>(std::numeric_limits<TypeParam>::max() / 8 * 7);
    for (const TypeParam low : {TypeParam(0), far}) {
        this->store_.resize(0);
        this->make(400, low, 100000, 3000, 5);
        const BinNeighbours<TypeParam> neighbours(this->store_, Lattice(Grid{{0.01, 0.02, 0.01}, {0, 0, 0}}));
        for (const double spacing : {0.0, 1.0, 30.0, 100.0}) {
            const auto expected = this->one_by_one(neighbours, spacing);
            const auto lists = neighbours.lists(spacing);
            ASSERT_TRUE(lists) << spacing;
            EXPECT_EQ(*lists, expected) << spacing;
        }
    }
}

// Where doubles hold no single steps.
TYPED_TEST(Neighbours, AreFoundFarFromTheFirstBin)
{
    const TypeParam far = std::numeric_limits<TypeParam>::max() / 4;
    this->make(300, far, 100000, 3000, 9);
    this->store_.resize(301);
    this->store_.put(300, {Point<TypeParam>{1, 2, 3}});
    const BinNeighbours<TypeParam> neighbours(this->store_, Lattice(Grid{{0.01, 0.01, 0.01}, {0, 0, 0}}));
    for (const double spacing : {1.0, 10.0, 50.0, 100.0}) {
        const auto lists = neighbours.lists(spacing);
        ASSERT_TRUE(lists) << spacing;
        EXPECT_EQ(*lists, this->one_by_one(neighbours, spacing)) << spacing;
    }
}

// Lists stay linear in the number of bins: at coarse spacings there are none.
TYPED_TEST(Neighbours, AreNotListedWhereMostBinsAreNear)
{
    this->make(400, 5, 100000, 3000, 6);
    const BinNeighbours<TypeParam> neighbours(this->store_, Lattice(Grid{{0.01, 0.01, 0.01}, {0, 0, 0}}));
    EXPECT_FALSE(neighbours.lists(1e4));
    std::size_t pairs = 0;
    for (const double spacing : {50.0, 100.0, 200.0, 400.0})
        if (const auto lists = neighbours.lists(spacing)) {
            pairs = 0;
            for (const auto& list : *lists) pairs += list.size();
            EXPECT_LE(pairs, 400 * BinNeighbours<TypeParam>::most_near);
        }
    EXPECT_GT(pairs, 0u);
}

TYPED_TEST(Neighbours, GroupsAreApartAndHoldEveryBinWithPoints)
{
    this->make(300, 9, 100000, 3000, 7);
    const BinNeighbours<TypeParam> neighbours(this->store_, Lattice(Grid{{0.01, 0.01, 0.01}, {0, 0, 0}}));
    const auto lists = neighbours.lists(60);
    ASSERT_TRUE(lists);
    std::vector<std::size_t> all;
    const auto groups = neighbours.apart(*lists);
    EXPECT_GT(groups.size(), 1u);
    for (const auto& group : groups)
        for (const std::size_t bin : group) {
            all.push_back(bin);
            for (const std::size_t other : group)
                EXPECT_FALSE(std::count((*lists)[bin].begin(), (*lists)[bin].end(), other)) << bin << " " << other;
        }
    std::sort(all.begin(), all.end());
    std::vector<std::size_t> with_points;
    for (std::size_t bin = 0; bin < 300; ++bin)
        if (this->store_.box(bin).points) with_points.push_back(bin);
    EXPECT_EQ(all, with_points);
}

TYPED_TEST(Neighbours, ASubsetHasThoseThatWereAdded)
{
    this->make(300, 9, 100000, 3000, 8);
    const BinNeighbours<TypeParam> neighbours(this->store_, Lattice(Grid{{0.01, 0.01, 0.01}, {0, 0, 0}}));
    typename BinNeighbours<TypeParam>::Subset subset(neighbours);
    std::vector<bool> added(300, false);
    for (const double spacing : {1e5, 300.0, 20.0}) {
        const auto expected = this->one_by_one(neighbours, spacing);
        for (std::size_t bin = 0; bin < 300; bin += 11)
            if (this->store_.box(bin).points) {
                subset.add(bin);
                added[bin] = true;
            }
        for (std::size_t bin = 0; bin < 300; ++bin) {
            if (this->store_.box(bin).points == 0) continue;
            std::vector<std::uint32_t> near;
            for (const std::uint32_t other : expected[bin])
                if (added[other]) near.push_back(other);
            EXPECT_EQ(subset.near(bin, spacing), near) << bin << ", " << spacing;
        }
    }
}

}  // namespace
}  // namespace pcm
