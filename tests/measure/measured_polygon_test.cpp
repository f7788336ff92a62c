// Polygons of measures against integers and sums in plain order.
#include "pcm/measure/polygon.h"

#include "tests/support.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace {

using namespace pcm;

struct Place {
    long long x, y;
};

long long turn_of(const Place& a, const Place& b, const Place& c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool on_edge(const Place& a, const Place& b, const Place& p)
{
    return turn_of(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
           std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
}

bool edges_meet(const Place& a, const Place& b, const Place& c, const Place& d)
{
    if (on_edge(a, b, c) || on_edge(a, b, d) || on_edge(c, d, a) || on_edge(c, d, b)) return true;
    const auto apart = [](long long p, long long q) { return (p < 0 && q > 0) || (p > 0 && q < 0); };
    return apart(turn_of(a, b, c), turn_of(a, b, d)) && apart(turn_of(c, d, a), turn_of(c, d, b));
}

// All pairs of edges that meet where they should not.
std::vector<std::pair<std::size_t, std::size_t>> crossings(const std::vector<Place>& polygon)
{
    const std::size_t n = polygon.size();
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (std::size_t i = 0; i < n; ++i) {
        const Place &a = polygon[i], &b = polygon[(i + 1) % n], &c = polygon[(i + 2) % n];
        if (turn_of(a, b, c) == 0 && (a.x - b.x) * (c.x - b.x) + (a.y - b.y) * (c.y - b.y) > 0)
            found.emplace_back(i, (i + 1) % n);
        for (std::size_t j = i + 2; j < n; ++j)
            if (!(i == 0 && j + 1 == n) && edges_meet(a, b, polygon[j], polygon[(j + 1) % n])) found.emplace_back(i, j);
    }
    return found;
}

TEST(MeasuredPolygon, CrossingsAreThoseOfAllPairsOfEdges)
{
    std::mt19937_64 random(1);
    int crossed = 0, folded = 0, plain = 0;
    for (int round = 0; round < 20000; ++round) {
        const std::size_t count = 3 + random() % 5;
        std::vector<Place> places;
        std::vector<Vec2d> polygon;
        while (places.size() < count) {
            const Place p{static_cast<long long>(random() % 7), static_cast<long long>(random() % 7)};
            if (!places.empty() && p.x == places.back().x && p.y == places.back().y) continue;
            places.push_back(p);
            polygon.push_back({4e6 + 0.5 * double(p.x), double(p.y) - 3});
        }
        if (places.front().x == places.back().x && places.front().y == places.back().y) continue;
        const auto expected = crossings(places);
        const auto found = find_crossing(polygon);
        ASSERT_EQ(found.has_value(), !expected.empty()) << round;
        if (!found) {
            ++plain;
            continue;
        }
        const std::pair<std::size_t, std::size_t> pair{found->first, found->second};
        EXPECT_NE(std::find(expected.begin(), expected.end(), pair), expected.end())
            << pair.first << ' ' << pair.second;
        ++(pair.second == (pair.first + 1) % count ? folded : crossed);
    }
    EXPECT_GT(plain, 1000);
    EXPECT_GT(crossed, 1000);
    EXPECT_GT(folded, 1000);
    EXPECT_FALSE(find_crossing({}));
    EXPECT_FALSE(find_crossing({{0, 0}, {1, 1}}));
}

// A spike at any corner, of a polygon that is right otherwise.
TEST(MeasuredPolygon, ASpikeIsFoundWhereverItIs)
{
    for (std::size_t at = 0; at < 6; ++at) {
        std::vector<Vec2d> polygon;
        for (std::size_t i = 0; i < 6; ++i) polygon.push_back({10 * std::cos(double(i)), 10 * std::sin(double(i))});
        EXPECT_FALSE(find_crossing(polygon));
        std::vector<Vec2d> spiked{{0, 0}, {8, 0}, {4, 0}, {4, 4}, {1, 6}, {0, 4}};
        std::rotate(spiked.begin(), spiked.begin() + static_cast<std::ptrdiff_t>(at), spiked.end());
        const auto found = find_crossing(spiked);
        ASSERT_TRUE(found) << at;
        EXPECT_EQ(found->first, (6 - at) % 6);
        EXPECT_EQ(found->second, (7 - at) % 6);
    }
}

TEST(MeasuredPolygon, AreasAreThoseOfTheSumOverItsEdges)
{
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int round = 0; round < 200; ++round) {
        std::vector<Vec3d> polygon, far;
        const Vec3d shift{5e6, 4e6, 300};
        for (std::size_t n = 1 + random() % 12; n > 0; --n) {
            polygon.push_back({unit(random), unit(random), unit(random)});
            far.push_back(polygon.back() + shift);
        }
        Vec3d expected{};
        for (std::size_t i = 0; i < polygon.size(); ++i)
            expected = expected + 0.5 * cross(polygon[i], polygon[(i + 1) % polygon.size()]);
        EXPECT_NEAR(length(vector_area(polygon) - expected), 0, 1e-14);
        EXPECT_NEAR(length(vector_area(far) - expected), 0, 1e-8) << "rounded coordinates, no more";
    }
    // Parts far from the first point cancel: thin triangles out to 1e8 and back.
    std::vector<Vec3d> fan{{0, 0, 0}};
    for (int i = 0; i < 1000; ++i) {
        fan.push_back({1e8, i + 0.1, 0});
        fan.push_back({1e8, -i - 0.3, 0});
    }
    long double area = 0;
    for (std::size_t i = 1; i + 1 < fan.size(); ++i)
        area += (static_cast<long double>(fan[i][0]) * fan[i + 1][1] -
                 static_cast<long double>(fan[i][1]) * fan[i + 1][0]) /
                2;
    EXPECT_NEAR(vector_area(fan)[2], static_cast<double>(area), 1e-3);
    EXPECT_EQ(length(vector_area({})), 0);
}

TEST(MeasuredPolygon, RepeatsAreLeftOut)
{
    const Vec3d a{1, 2, 3}, b{1, 2, 4}, c{0, 0, 0};
    EXPECT_EQ(without_repeats({a, a, b, b, b, c, a, a}), (std::vector<Vec3d>{a, b, c}));
    EXPECT_EQ(without_repeats({a, b, a, b, a}), (std::vector<Vec3d>{a, b, a, b}));
    EXPECT_EQ(without_repeats({a, a, a}), (std::vector<Vec3d>{a}));
    EXPECT_TRUE(without_repeats({}).empty());
    EXPECT_EQ(in_plan({a, c}), (std::vector<Vec2d>{{1, 2}, {0, 0}}));
}

// Lengths and the sense of turning are kept, along every axis too.
TEST(MeasuredPolygon, SeenAlongANormalItTurnsAsItsAreaSays)
{
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (int round = 0; round < 200; ++round) {
        Vec3d n{normal(random), normal(random), normal(random)};
        if (round < 6) {
            n = {};
            n[static_cast<std::size_t>(round / 2)] = round % 2 ? 1 : -1;
        }
        n = normalised(n);
        const Vec3d other = std::fabs(n[0]) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
        const Vec3d u = normalised(cross(other, n)), v = cross(n, u);
        std::vector<Vec3d> polygon;
        for (int i = 0; i < 7; ++i)
            polygon.push_back(Vec3d{100, 200, 300} + 3 * std::cos(0.9 * i) * u + 2 * std::sin(0.9 * i) * v +
                              normal(random) * n);
        const std::vector<Vec2d> flat = seen_along(polygon, n);
        ASSERT_EQ(flat.size(), polygon.size());
        double area = 0;
        for (std::size_t i = 0; i < flat.size(); ++i) {
            const Vec2d &p = flat[i], &q = flat[(i + 1) % flat.size()];
            area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
            const Vec3d d = polygon[i] - polygon[0];
            EXPECT_NEAR(std::hypot(p[0], p[1]), length(d - dot(d, n) * n), 1e-9) << "from the first point";
        }
        EXPECT_NEAR(area, dot(vector_area(polygon), n), 1e-9);
        EXPECT_GT(area, 1);
    }
}

}  // namespace
