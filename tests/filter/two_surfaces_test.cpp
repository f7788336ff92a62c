// Which neighbourhoods are two sheets: plates, single surfaces and steps whose truth is known.
#include "pcm/filter/two_surfaces.h"

#include "pcm/cloud/symmetric_eigen.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace pcm {
namespace {

struct Neighbourhood {
    std::vector<double> x, y, z, squared;
    void add(const Vec3d& d)
    {
        x.push_back(d[0]);
        y.push_back(d[1]);
        z.push_back(d[2]);
        squared.push_back(dot(d, d));
    }
    OnePointsNeighbours view() const { return {x.data(), y.data(), z.data(), squared.data(), x.size()}; }
    // The normal of the point and its neighbours, as the filter computes it.
    Vec3d normal() const
    {
        const double n = static_cast<double>(x.size() + 1);
        Vec3d middle{};
        for (std::size_t j = 0; j < x.size(); ++j) middle = middle + Vec3d{x[j], y[j], z[j]} / n;
        SquareMatrix<3> scatter{};
        for (std::size_t j = 0; j <= x.size(); ++j) {
            const Vec3d d = (j < x.size() ? Vec3d{x[j], y[j], z[j]} : Vec3d{}) - middle;
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t b = 0; b < 3; ++b) scatter[a][b] += d[a] * d[b];
        }
        const std::array<double, 3> v = eigensystem<3>(scatter).vectors[0];
        return {v[0], v[1], v[2]};
    }
};

// The `count` nearest of the points to the one nearest to the origin.
Neighbourhood nearest(const std::vector<Vec3d>& points, std::size_t count)
{
    const auto is_nearer = [](const Vec3d& a, const Vec3d& b) { return dot(a, a) < dot(b, b); };
    const Vec3d at = *std::min_element(points.begin(), points.end(), is_nearer);
    std::vector<Vec3d> offsets;
    for (const Vec3d& p : points)
        if (p != at) offsets.push_back(p - at);
    std::sort(offsets.begin(), offsets.end(), is_nearer);
    Neighbourhood result;
    for (std::size_t j = 0; j < count; ++j) result.add(offsets[j]);
    return result;
}

using Height = std::function<double(double x, double y, std::mt19937_64& random)>;

// 200 points in a square of side 10 about the origin, so half a unit or so apart.
std::vector<Vec3d> scattered(std::uint64_t seed, const Height& height)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(-5, 5);
    std::vector<Vec3d> points;
    for (int i = 0; i < 200; ++i) {
        const double x = place(random), y = place(random);
        points.push_back({x, y, height(x, y, random)});
    }
    return points;
}

Height plate(double gap, double noise)
{
    return [=](double, double, std::mt19937_64& random) {
        std::normal_distribution<double> gauss(0, noise);
        return (random() % 2 ? gap : 0) + gauss(random);
    };
}

// The share of 2000 random neighbourhoods in which two surfaces are seen.
double share_seen(const Height& height, std::size_t neighbours = 16, double least_gap = 0)
{
    int seen = 0;
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        const Neighbourhood n = nearest(scattered(seed, height), neighbours);
        seen += are_two_surfaces(n.view(), n.normal(), least_gap);
    }
    return seen / 2000.0;
}

// The more neighbours, the more plates: of 16 at least three in four, of 40 nearly all.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(TwoSurfaces, PCM_NOT_UNDER_THREAD(PlatesAreSeen))
{
    for (const double gap : {0.02, 0.25})
        for (const double noise : {0.0, 0.1}) {
            EXPECT_GT(share_seen(plate(gap, noise * gap)), 0.75) << gap << " " << noise;
            EXPECT_GT(share_seen(plate(gap, noise * gap), 40), 0.97) << gap << " " << noise;
        }
    EXPECT_LT(share_seen(plate(0.1, 0.05)), 0.02);  // a gap of twice the noise is none
}

// Heights that depend on the place, and noise of one surface, are seldom taken for two.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(TwoSurfaces, PCM_NOT_UNDER_THREAD(SingleSurfacesAreNot))
{
    const std::vector<Height> surfaces{
        [](double, double, std::mt19937_64& r) { return std::normal_distribution<double>(0, 0.05)(r); },
        [](double, double, std::mt19937_64& r) { return std::uniform_real_distribution<double>(0, 0.1)(r); },
        [](double x, double y, std::mt19937_64&) { return 0.1 * std::sin(2 * x) * std::cos(y); },
        [](double x, double, std::mt19937_64&) { return x > 0 ? 0.2 : 0.0; },
        [](double x, double y, std::mt19937_64&) { return x + y > 0.3 ? 0.2 : 0.0; },
        [](double x, double y, std::mt19937_64&) { return x + 0.4 * y * y > 0.1 ? 0.2 : 0.0; },
        [](double x, double y, std::mt19937_64&) { return y + 0.4 * x * x > 0.1 ? 0.2 : 0.0; },
        [](double x, double, std::mt19937_64&) { return 0.3 * std::fabs(x); },
        [](double x, double y, std::mt19937_64&) { return 0.05 * (x * x + y * y); }};
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        EXPECT_LT(share_seen(surfaces[i], 9), 0.05) << i;
        EXPECT_LT(share_seen(surfaces[i], 16), 0.02) << i;
    }
}

// Two sheets of a square lattice each, one above the other's gaps, and the point at a corner.
Neighbourhood lattices(std::size_t lower, std::size_t upper, double gap)
{
    Neighbourhood n;
    for (std::size_t i = 1; i <= lower; ++i) n.add({double(i % 3), double(i / 3), 0});
    for (std::size_t i = 0; i < upper; ++i) n.add({0.5 + double(i % 3), 0.5 + double(i / 3), gap});
    return n;
}

const Vec3d up{0, 0, 1};

TEST(TwoSurfaces, NeedNineNeighboursAndThreePointsEach)
{
    EXPECT_FALSE(are_two_surfaces(lattices(4, 4, 0.1).view(), up, 0));
    EXPECT_TRUE(are_two_surfaces(lattices(4, 5, 0.1).view(), up, 0));
    EXPECT_TRUE(are_two_surfaces(lattices(8, 3, 0.1).view(), up, 0));
    EXPECT_FALSE(are_two_surfaces(lattices(8, 2, 0.1).view(), up, 0));
    EXPECT_TRUE(are_two_surfaces(lattices(2, 9, 0.1).view(), up, 0));  // the point is the lower sheet's third
    EXPECT_FALSE(are_two_surfaces(lattices(1, 9, 0.1).view(), up, 0));
}

TEST(TwoSurfaces, AreFartherApartThanTheLeastGap)
{
    const Neighbourhood n = lattices(8, 9, 0.1);
    EXPECT_TRUE(are_two_surfaces(n.view(), up, 0.0999));
    EXPECT_FALSE(are_two_surfaces(n.view(), up, 0.1001));
    EXPECT_TRUE(are_two_surfaces(n.view(), -1.0 * up, 0.0999));
}

// Turned, mirrored and in other units; the normal is that of the points.
TEST(TwoSurfaces, AreSeenInAnyDirectionAndUnit)
{
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    const std::vector<Vec3d> two = scattered(3, plate(0.05, 0.002)), one = scattered(3, plate(0, 0.05));
    for (const double size : {1e-60, 1e-6, 1.0, 1e6, 1e60})
        for (int turn = 0; turn < 9; ++turn) {
            const Vec3d a = turn < 3 ? Vec3d{double(turn == 0), double(turn == 1), double(turn == 2)}
                                     : normalised(Vec3d{unit(random), unit(random), unit(random)});
            const Vec3d b = normalised(cross(a, Vec3d{0.3, 0.5, 0.7})), c = cross(a, b);
            for (const bool is_two : {true, false}) {
                std::vector<Vec3d> turned;
                for (const Vec3d& p : is_two ? two : one) turned.push_back(size * (p[0] * b + p[1] * c + p[2] * a));
                const Neighbourhood n = nearest(turned, 40);
                EXPECT_EQ(are_two_surfaces(n.view(), n.normal(), 0), is_two) << size << " " << turn;
                EXPECT_FALSE(are_two_surfaces(n.view(), n.normal(), 0.06 * size)) << size << " " << turn;
            }
        }
}

// What is behind the 64 nearest says nothing of the surface here.
TEST(TwoSurfaces, AreSeenByThe64Nearest)
{
    Neighbourhood n = nearest(scattered(3, plate(0.05, 0.002)), 64);
    const Vec3d normal = n.normal();
    ASSERT_TRUE(are_two_surfaces(n.view(), normal, 0));
    for (int i = 0; i < 100; ++i) n.add({5 + 0.1 * i, 3 - 0.07 * i, 0.37 * (i % 17)});
    EXPECT_TRUE(are_two_surfaces(n.view(), normal, 0));
    Neighbourhood many;  // the 64th neighbour still counts: it is the upper sheet's third
    for (std::size_t i = 0; i < 63; ++i) many.add({double(i % 8), double(i / 8), i < 2 ? 0.1 : 0});
    many.add({3.5, 3.5, 0.1});
    const bool with = are_two_surfaces(many.view(), up, 0);
    many.add({3.7, 4.5, 0.1});
    EXPECT_EQ(are_two_surfaces(many.view(), up, 0), with);
    EXPECT_TRUE(with);
}

TEST(TwoSurfaces, AGapIsAcrossFromThirtyDegreesOn)
{
    for (const double size : {1e-9, 1.0, 1e9})
        for (const double side : {1.0, -1.0}) {
            const auto at = [&](double degrees) {
                const double angle = degrees / 180 * std::acos(-1.0);
                return size * Vec3d{0.6 * std::cos(angle), 0.8 * std::cos(angle), side * std::sin(angle)};
            };
            EXPECT_FALSE(is_across(at(29.9), up));
            EXPECT_TRUE(is_across(at(30.1), up));
            EXPECT_TRUE(is_across(at(90), up));
            EXPECT_FALSE(is_across(at(0), up));
        }
}

}  // namespace
}  // namespace pcm
