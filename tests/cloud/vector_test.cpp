// Vector algebra against long double, and the promises that other code builds on: order, monotonicity.
#include "pcm/cloud/vector.h"

#include "pcm/cloud/box_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace pcm;
using Long = long double;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Coordinates of very different sizes, offsets of maps among them.
class Vectors {
public:
    explicit Vectors(std::uint64_t seed) : random_(seed) {}
    double number(int least = -20, int most = 20)
    {
        const double v = std::uniform_real_distribution<double>(-1, 1)(random_);
        return random_() % 16 == 0 ? 0.0
                                   : std::ldexp(v, std::uniform_int_distribution<int>(least, most)(random_)) +
                                         (random_() % 4 == 0 ? 5e6 : 0.0);
    }
    Vec3d vector() { return {number(), number(), number()}; }
    std::mt19937_64& engine() { return random_; }

private:
    std::mt19937_64 random_;
};

TEST(Vector, ProductsAreWithinRoundingOfTheExactOnes)
{
    Vectors vectors(1);
    for (int i = 0; i < 20000; ++i) {
        const Vec3d a = vectors.vector(), b = vectors.vector();
        Long sum = 0, size = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            sum += static_cast<Long>(a[k]) * b[k];
            size += std::abs(static_cast<Long>(a[k]) * b[k]);
        }
        ASSERT_LE(std::abs(dot(a, b) - sum), 2 * epsilon * size);
        const Vec3d c = cross(a, b);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
            const Long one = static_cast<Long>(a[l]) * b[m], other = static_cast<Long>(a[m]) * b[l];
            ASSERT_LE(std::abs(c[k] - (one - other)), 1.5 * epsilon * (std::abs(one) + std::abs(other)));
        }
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_EQ((a + b)[k], a[k] + b[k]);
            ASSERT_EQ((a - b)[k], a[k] - b[k]);
            ASSERT_EQ((3.7 * a)[k], 3.7 * a[k]);
            ASSERT_EQ((a / 3.7)[k], a[k] / 3.7);
        }
    }
}

// Files and pictures depend on this order: from the first coordinate to the last.
TEST(Vector, DotSumsFromTheFirstCoordinate)
{
    EXPECT_EQ(dot({1e16, 1, -1e16}, {1, 1, 1}), 0);
    EXPECT_EQ(dot({1e16, -1e16, 1}, {1, 1, 1}), 1);
    EXPECT_EQ(squared_distance(Vec3d{1e8, 1, 1}, Vec3d{0, 0, 0}), 1e16);
    EXPECT_EQ(squared_distance(Vec3d{1, 1, 1e8}, Vec3d{0, 0, 0}), 1e16 + 2);
}

TEST(Vector, LengthNeitherOverflowsNorUnderflows)
{
    for (const double unit : {1e-300, 1e-160, 1.0, 1e160, 1e300}) {
        EXPECT_DOUBLE_EQ(length({2 * unit, -3 * unit, 6 * unit}), 7 * unit);
        const Vec3d n = normalised({2 * unit, -3 * unit, 6 * unit});
        EXPECT_DOUBLE_EQ(n[0], 2.0 / 7);
        EXPECT_DOUBLE_EQ(n[1], -3.0 / 7);
        EXPECT_DOUBLE_EQ(n[2], 6.0 / 7);
    }
    EXPECT_TRUE(std::isnan(normalised({0, 0, 0})[0]));
}

TEST(Vector, FiniteAndLargest)
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(is_finite({1e308, -1e308, 0}));
    for (std::size_t a = 0; a < 3; ++a)
        for (const double bad : {infinity, -infinity, std::nan("")}) {
            Vec3d v{1, 2, 3};
            v[a] = bad;
            EXPECT_FALSE(is_finite(v));
        }
    EXPECT_EQ(largest_magnitude({1, -7, 3}), 7);
    EXPECT_EQ(largest_magnitude({0, 0, -0.0}), 0);
}

TEST(Vector, DistancesOnAGridAreSymmetricAndExactBelow2To53Steps)
{
    std::mt19937_64 random(2);
    const Vec3d squared{1e-6, 4e-6, 1e-2};
    const auto check = [&](auto zero, unsigned bits) {
        using T = decltype(zero);
        for (int i = 0; i < 5000; ++i) {
            std::array<T, 3> p, q;
            Long sum = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                p[a] = static_cast<T>(random() >> (64 - bits));
                q[a] = static_cast<T>(random() >> (64 - bits));
                const Long d = static_cast<Long>(p[a]) - static_cast<Long>(q[a]);
                sum += d * d * squared[a];
            }
            ASSERT_EQ(squared_distance(p, q, squared), squared_distance(q, p, squared));
            ASSERT_NEAR(squared_distance(p, q, squared), static_cast<double>(sum),
                        4 * epsilon * static_cast<double>(sum));
        }
    };
    check(std::uint32_t{}, 32);
    check(std::uint64_t{}, 53);
    check(std::int64_t{}, 53);
    EXPECT_EQ(squared_distance(Vec3i{-5, 0, 0}, Vec3i{5, 0, 0}, {2, 1, 1}), 200);
}

// Searches stop at boxes by this: no point of a box is nearer than the box.
TEST(BoxDistance, NoPointOfTheBoxIsNearer)
{
    Vectors vectors(3);
    std::uniform_real_distribution<double> share(0, 1);
    for (int i = 0; i < 4000; ++i) {
        Box3d box;
        box.extend(vectors.vector());
        if (i % 5) box.extend(vectors.vector());  // else a point
        const Vec3d q = vectors.vector();
        const double least = squared_distance(box, q);
        Long exact = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const Long d =
                std::max({Long(0), static_cast<Long>(box.min[a]) - q[a], static_cast<Long>(q[a]) - box.max[a]});
            exact += d * d;
        }
        ASSERT_NEAR(least, static_cast<double>(exact), 4 * epsilon * static_cast<double>(exact));
        if (box.contains(q)) ASSERT_EQ(least, 0);
        for (int j = 0; j < 20; ++j) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = j < 8 ? (j >> a & 1 ? box.max[a] : box.min[a])
                             : std::clamp(box.min[a] + share(vectors.engine()) * box.extent(a), box.min[a], box.max[a]);
            ASSERT_GE(squared_distance(p, q), least);
        }
    }
}

}  // namespace
