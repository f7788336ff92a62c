// Morton codes against bits taken one by one.
#include "pcm/cloud/morton.h"

#include "pcm/cloud/geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace {

using namespace pcm;

TEST(Morton, SpreadsTheLow21Bits)
{
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t v = i < 64 ? std::uint64_t(1) << i : i == 64 ? ~std::uint64_t(0) : random();
        std::uint64_t expected = 0;
        for (unsigned bit = 0; bit < 21; ++bit) expected |= (v >> bit & 1) << (3 * bit);
        ASSERT_EQ(spread_bits(v), expected) << v;
    }
}

// The axis that decides is the one with the highest bit that differs; of equal ones z before y before x.
std::vector<std::uint32_t> naive_order(const std::vector<Vec3d>& points)
{
    Box3d box;
    for (const Vec3d& p : points) box.extend(p);
    const double side = std::max({box.extent(0), box.extent(1), box.extent(2)});
    const auto cell = [&](std::uint32_t i, std::size_t a) {
        if (!(side > 0)) return 0;
        return std::min(static_cast<int>((points[i][a] - box.min[a]) / side * 2097152), 2097151);
    };
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
        for (int bit = 20; bit >= 0; --bit)
            for (const std::size_t a : {2u, 1u, 0u}) {
                const int one = cell(i, a) >> bit & 1, other = cell(j, a) >> bit & 1;
                if (one != other) return one < other;
            }
        return false;
    });
    return order;
}

TEST(Morton, OrdersPointsByTheBitsOfTheirCells)
{
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int round = 0; round < 24; ++round) {
        const Vec3d offset = round % 2 ? Vec3d{5e5, 5e6, -100} : Vec3d{0, 0, 0};
        std::vector<Vec3d> points(round % 6 == 0 ? 5 : 700);
        for (Vec3d& p : points) {
            p = offset;
            switch (round % 4) {
                case 0:  // a volume
                    for (double& v : p) v += 100 * unit(random);
                    break;
                case 1:  // a line along y
                    p[1] += 1000 * unit(random);
                    break;
                case 2:  // few places, so that many points share a cell
                    for (double& v : p) v += static_cast<double>(random() % 3);
                    break;
                default:  // all at one place
                    break;
            }
        }
        EXPECT_EQ(morton_order(points), naive_order(points)) << round;
    }
    EXPECT_TRUE(morton_order({}).empty());
    EXPECT_EQ(morton_order({{1, 2, 3}}), std::vector<std::uint32_t>{0});
}

}  // namespace
