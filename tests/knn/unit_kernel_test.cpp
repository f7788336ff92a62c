#include "pcm/knn/unit_kernel.h"

#include "pcm/knn/unit_tree.h"
#include "tests/knn/search_clouds.h"
#include "tests/knn/simd_levels.h"

#include <gtest/gtest.h>

#include <ctime>

namespace pcm {
namespace {

using search_clouds::InBox;

// How many queries single precision could not decide, of all points of the cloud, k = 16.
std::uint32_t undecided(std::vector<TreePoint<std::int64_t>> points, const Vec3d& scale = {1, 1, 1})
{
    constexpr std::size_t k = 16;
    const UnitTree<std::int64_t> tree(std::move(points), scale, {1, 1, 1});
    AlignedArray<std::uint64_t> lists(list_words(k));
    std::vector<std::uint32_t> ids(leaf_points * k), counts(leaf_points);
    std::vector<double> squares(leaf_points * k);
    std::uint32_t repeated = 0;
    KernelRequest request;
    request.neighbours = request.stride = k;
    request.limit = std::numeric_limits<double>::infinity();
    request.ids = ids.data();
    request.squares = squares.data();
    request.counts = counts.data();
    request.lists = lists.data();
    request.repeated = &repeated;
    for (std::uint32_t leaf = 0; leaf < tree.view().leaves; ++leaf)
        unit_kernels().wide(tree.view(), {tree.leaf(leaf), ~0u, leaf}, request);
    return repeated;
}

std::vector<TreePoint<std::int64_t>> points_at(std::size_t size, const std::function<Vec3i(std::size_t)>& place)
{
    std::vector<TreePoint<std::int64_t>> points(size);
    for (std::size_t i = 0; i < size; ++i) {
        const Vec3i at = place(i);
        points[i] = {{at[0], at[1], at[2]}, static_cast<std::uint32_t>(i)};
    }
    return points;
}

// The points in the leaf of a stray are searched without it: its distance would cost them their precision, and each of
// them the comparison with all points. To the stray itself all others are equally far.
TEST(UnitKernel, AStrayDoesNotBlindThePointsInItsLeaf)
{
    at_each_level([] {
        InBox cluster(1000, 1000, 1000);
        // The stray, and points with a tie between their 16th neighbour and the next.
        EXPECT_LT(undecided(points_at(3200,
                                      [&](std::size_t i) {
                                          return i ? cluster() : Vec3i{1ll << 50, 0, 0};
                                      })),
                  6u);
    });
}

TEST(UnitKernel, OnlyTiesAreUndecided)
{
    at_each_level([] {
        const auto lattice = [](std::int64_t step) {
            return points_at(1024, [=](std::size_t i) {
                const auto n = static_cast<std::int64_t>(i);
                return Vec3i{n % 16 * step, n / 16 % 8 * step, n / 128 * step};
            });
        };
        EXPECT_GT(undecided(lattice(1000003)), 500u);
        EXPECT_GT(undecided(lattice(100)), 500u);
        EXPECT_EQ(undecided(points_at(1024,  // distances along a line, none of which is another's
                                      [](std::size_t i) {
                                          const auto n = static_cast<std::int64_t>(i);
                                          return Vec3i{5 * n + (n * n) % 1024 / 512, 0, 0};
                                      })),
                  0u);
        EXPECT_EQ(undecided(points_at(1024,
                                      [](std::size_t i) {
                                          return Vec3i{static_cast<std::int64_t>(i / 32), 0, 0};
                                      })),
                  0u);  // the nearest are at the same place
    });
}

// Points that have all neighbours at their own place are done with those. The search stops there, so that it takes
// seconds for a million points at one place: here 0.1 s, and 40 s where each was compared with all.
TEST(UnitKernel, PointsAtOnePlaceAreNotComparedWithAll)
{
    const Vec3d unlike{1, 1.25, 0.3};
    at_each_level([&] {
        EXPECT_EQ(undecided(points_at(1024, [](std::size_t) { return Vec3i{5, 6, 7}; }), unlike), 0u);
        const auto start = std::clock();
        undecided(points_at(200000, [](std::size_t i) { return Vec3i{i < 16, 0, 0}; }), unlike);
        EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5);
    });
}

}  // namespace
}  // namespace pcm
