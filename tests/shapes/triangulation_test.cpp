#include "pcm/shapes/triangulation.h"
#include "pcm/shapes/concave_outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>

namespace pcm {
namespace {

std::vector<Vec2d> drawn(std::size_t count, const std::function<Vec2d(std::mt19937_64&)>& draw)
{
    std::mt19937_64 random(count);
    std::vector<Vec2d> points;
    while (points.size() < count) points.push_back(draw(random));
    return points;
}

std::vector<std::vector<Vec2d>> nasty_sets()
{
    std::uniform_real_distribution<double> unit(0, 1);
    std::uniform_int_distribution<int> coarse(0, 9);
    std::vector<std::vector<Vec2d>> sets;
    for (const std::size_t count : {3u, 4u, 5u, 6u, 7u, 50u, 300u}) {
        sets.push_back(drawn(count, [&](auto& r) { return Vec2d{unit(r), unit(r)}; }));
        sets.push_back(drawn(count, [&](auto& r) { return Vec2d{1.0 * coarse(r), 1.0 * coarse(r)}; }));
        sets.push_back(drawn(count, [&](auto& r) {
            const double turn = 7 * unit(r);
            return Vec2d{std::cos(turn), std::sin(turn)};
        }));
        sets.push_back(drawn(count, [&](auto& r) { return Vec2d{unit(r), 1e-8 * unit(r)}; }));
        sets.push_back(drawn(count, [&](auto& r) {
            return Vec2d{1e9 * coarse(r), std::ldexp(1.0, -coarse(r)) * 1e9};
        }));
    }
    return sets;
}

struct Triangle {
    std::uint32_t a, b, c;
};

std::vector<Triangle> triangles_of(const Triangulation& mesh, const FlatPoints& points)
{
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < mesh.edges(); ++i) {
        const auto a = mesh.edge(i), b = mesh.around_left(a), c = mesh.around_left(b);
        if (a > b || a > c || mesh.around_left(c) != a) continue;
        const Triangle found{mesh.origin(a), mesh.origin(b), mesh.origin(c)};
        if (turn_of(points[found.a], points[found.b], points[found.c]) > 0) triangles.push_back(found);
    }
    return triangles;
}

long double in_circle(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c, const FlatPoint& d)
{
    const auto row = [&](const FlatPoint& p) {
        const long double x = p.x - static_cast<long double>(d.x), y = p.y - static_cast<long double>(d.y);
        return std::array<long double, 3>{x, y, x * x + y * y};
    };
    const auto p = row(a), q = row(b), r = row(c);
    return p[2] * (q[0] * r[1] - q[1] * r[0]) + q[2] * (r[0] * p[1] - r[1] * p[0]) + r[2] * (p[0] * q[1] - p[1] * q[0]);
}

TEST(Triangulations, CoverTheHullAndHaveEmptyCircles)
{
    std::size_t checked = 0;
    for (const auto& set : nasty_sets()) {
        const FlatPoints points(set);
        const auto hull = points.convex_hull();
        if (hull.size() < 3) continue;
        const Triangulation mesh(points);
        long double area = 0, sum = 0;
        for (std::size_t i = 1; i + 1 < hull.size(); ++i)
            area += turn_of(points[hull[0]], points[hull[i]], points[hull[i + 1]]);
        for (const Triangle& t : triangles_of(mesh, points)) {
            sum += turn_of(points[t.a], points[t.b], points[t.c]);
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (i == t.a || i == t.b || i == t.c) continue;
                EXPECT_LE(in_circle(points[t.a], points[t.b], points[t.c], points[i]), 1e18L * 1e3L);
            }
            ++checked;
        }
        EXPECT_EQ(sum, area) << points.size() << " points";
        std::set<std::uint32_t> on_hull;
        for (const auto e : mesh.hull()) on_hull.insert(mesh.origin(e));
        for (const std::uint32_t corner : hull) EXPECT_TRUE(on_hull.count(corner));
    }
    EXPECT_GT(checked, 2000u);
}

// Crossing edges, by trying all pairs.
bool crosses_itself(const FlatPoints& points, const std::vector<std::uint32_t>& outline)
{
    const std::size_t count = outline.size();
    const auto at = [&](std::size_t i) { return points[outline[i % count]]; };
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j) {
            const auto sign = [](std::int64_t x) { return (x > 0) - (x < 0); };
            if (sign(turn_of(at(i), at(i + 1), at(j))) * sign(turn_of(at(i), at(i + 1), at(j + 1))) < 0 &&
                sign(turn_of(at(j), at(j + 1), at(i))) * sign(turn_of(at(j), at(j + 1), at(i + 1))) < 0)
                return true;
        }
    return false;
}

TEST(ConcaveOutlines, AreSimpleAndHoldAllPoints)
{
    for (const auto& set : nasty_sets()) {
        const FlatPoints points(set);
        if (points.convex_hull().size() < 3) continue;
        for (const double edge : {0.0, 1e-6, 0.1, 1e9}) {
            const auto outline = concave_outline(points, edge);
            EXPECT_EQ(std::set<std::uint32_t>(outline.begin(), outline.end()).size(), outline.size())
                << "visited twice";
            EXPECT_FALSE(crosses_itself(points, outline));
            std::vector<Vec2d> corners;
            for (const std::uint32_t p : outline) corners.push_back({1.0 * points[p].x, 1.0 * points[p].y});
            const Polygon polygon(corners);
            const std::set<std::uint32_t> on_it(outline.begin(), outline.end());
            for (std::uint32_t i = 0; i < points.size(); ++i) {
                if (on_it.count(i)) continue;
                bool along = false;  // an edge: where points are on one line, it may go through between corners
                for (std::size_t k = 0; k < outline.size(); ++k)
                    along |= turn_of(points[outline[k]], points[outline[(k + 1) % outline.size()]], points[i]) == 0;
                EXPECT_TRUE(along || polygon.contains(points[i].x, points[i].y));
            }
        }
    }
}

}  // namespace
}  // namespace pcm
