// Points as fits compute with them, the draw of samples, and hulls, each against plain sums over all points.
#include "pcm/fit/working_points.h"

#include "pcm/fit/sample_draw.h"
#include "pcm/shapes/flat_points.h"
#include "tests/support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace {

using namespace pcm;

FitPoints box_of_points(std::size_t count, const Vec3d& at, const Vec3d& sides)
{
    std::mt19937_64 random(count);
    std::uniform_real_distribution<double> unit(-0.5, 0.5);
    FitPoints points;
    points.origin = at;
    for (std::size_t i = 0; i < count; ++i)
        points.add(at + Vec3d{sides[0] * unit(random), sides[1] * unit(random), sides[2] * unit(random)},
                   normalised(Vec3d{unit(random), unit(random), 1}));
    return points;
}

TEST(WorkingPoints, AreAllPointsInUnitsOfTheirExtent)
{
    for (const double size : {1e-300, 1e-3, 1.0, 100.0, 1e9}) {
        const FitPoints points = box_of_points(997, {3 * size, -size, 0.5 * size}, {size, 0.5 * size, 0.1 * size});
        PointSpread spread;
        ASSERT_EQ(obvious_issue(points, ShapeKind::sphere, 4, spread), FitIssue::none);
        Vec3d middle{};
        for (std::size_t i = 0; i < points.size(); ++i) middle = middle + points.at(i) / 997.0;
        double extent = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            extent = std::max(extent, largest_magnitude(points.at(i) - middle));
        EXPECT_NEAR(length(spread.middle - middle) / size, 0, 1e-14);
        EXPECT_NEAR(spread.extent / extent, 1, 1e-13);
        EXPECT_NEAR(spread.across[2] * extent / size, 1 / std::sqrt(12.0), 0.02);
        EXPECT_NEAR(spread.across[1] * extent / size, 0.5 / std::sqrt(12.0), 0.02);
        EXPECT_NEAR(spread.across[0] * extent / size, 0.1 / std::sqrt(12.0), 0.01);
        const WorkingPoints working = working_points(points, spread, 7);
        ASSERT_EQ(working.size(), points.size());
        EXPECT_EQ(working.unit, std::exp2(std::ceil(std::log2(extent))));
        std::set<std::uint32_t> seen;
        double largest = 0;
        for (std::size_t i = 0; i < working.size(); ++i) {
            seen.insert(working.index[i]);
            const Vec3d back = working.middle + working.unit * working.at(i);
            ASSERT_NEAR(length(back - points.source(working.index[i])) / size, 0, 1e-14);
            ASSERT_EQ(working.normal(i), points.normal(working.index[i]));
            largest = std::max(largest, largest_magnitude(working.at(i)));
        }
        EXPECT_EQ(seen.size(), points.size()) << "each once";
        EXPECT_LE(largest, 1);
        EXPECT_GT(largest, 0.5);
        EXPECT_EQ(working_points(points, spread, 7).index, working.index) << "the same seed, the same order";
        EXPECT_NE(working_points(points, spread, 8).index, working.index);
        std::size_t in_place = 0;
        for (std::size_t i = 0; i < working.size(); ++i) in_place += working.index[i] == i;
        EXPECT_LT(in_place, 10u) << "in random order";
    }
}

TEST(WorkingPoints, AShapeGoesThereAndBack)
{
    for (const ShapeTraits& traits : shape_kinds()) {
        Shape shape{traits.kind, {10, 20, 30}, {0, 0, 1}, 6, traits.kind == ShapeKind::cone ? 0.3 : 2};
        const Shape working = scaled(shape, {2, 4, 6}, 4);
        EXPECT_EQ(working.point, (Vec3d{2, 4, 6}));
        EXPECT_EQ(working.axis, shape.axis);
        for (const ShapeSize& size : traits.sizes)
            EXPECT_EQ(working.*size.value, shape.*size.value / (size.unit == SizeUnit::length ? 4 : 1)) << size.key;
        EXPECT_EQ(traits.has_radius(), working.radius == 1.5);
        EXPECT_EQ(working.second, traits.kind == ShapeKind::torus ? 0.5 : shape.second) << "angles stay";
        const Shape back = unscaled(working, {2, 4, 6}, 4);
        EXPECT_EQ(back.point, shape.point);
        EXPECT_EQ(back.radius, shape.radius);
        EXPECT_EQ(back.second, shape.second);
    }
}

TEST(WorkingPoints, WhatDeterminesNoShapeIsNamed)
{
    const auto issue = [](const FitPoints& points, ShapeKind kind) {
        PointSpread spread;
        return obvious_issue(points, kind, 4, spread);
    };
    FitPoints points = box_of_points(4, {1, 2, 3}, {1, 1, 1});
    EXPECT_EQ(issue(points, ShapeKind::sphere), FitIssue::none);
    points = box_of_points(3, {1, 2, 3}, {1, 1, 1});
    EXPECT_EQ(issue(points, ShapeKind::sphere), FitIssue::too_few_points);
    EXPECT_EQ(issue(box_of_points(50, {1, 2, 3}, {1, 1, 0}), ShapeKind::sphere), FitIssue::coplanar);
    EXPECT_EQ(issue(box_of_points(50, {1, 2, 3}, {1, 1, 0}), ShapeKind::plane), FitIssue::none);
    EXPECT_EQ(issue(box_of_points(50, {1, 2, 3}, {0, 1, 0}), ShapeKind::plane), FitIssue::collinear);
    EXPECT_EQ(issue(box_of_points(50, {1, 2, 3}, {0, 0, 0}), ShapeKind::plane), FitIssue::coincident);
    // Flat to a ten-millionth, or to the digits of map coordinates.
    EXPECT_EQ(issue(box_of_points(500, {0, 0, 0}, {1, 1, 1e-7}), ShapeKind::sphere), FitIssue::coplanar);
    EXPECT_EQ(issue(box_of_points(500, {0, 0, 0}, {1, 1, 1e-6}), ShapeKind::sphere), FitIssue::none);
    EXPECT_EQ(issue(box_of_points(500, {1e9, 0, 0}, {1, 1, 1e-6}), ShapeKind::sphere), FitIssue::coplanar);
    EXPECT_EQ(issue(box_of_points(500, {1e9, 0, 0}, {1e-7, 1e-7, 1e-7}), ShapeKind::sphere), FitIssue::coincident);
    for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        for (std::size_t a = 0; a < 4; ++a) {
            points = box_of_points(50, {1, 2, 3}, {1, 1, 1});
            (a == 0 ? points.x[49] : a == 1 ? points.y[7] : a == 2 ? points.z[0] : points.origin[1]) = bad;
            EXPECT_EQ(issue(points, ShapeKind::sphere), FitIssue::not_finite);
        }
}

// Chum and Matas: of the n best points as many samples are drawn as of T_N random ones lie among them.
TEST(SampleDraws, TakeTheBestPointsFirst)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    FitPoints points;
    for (int i = 0; i < 900; ++i)  // a plane, and points anywhere above it
        points.add(i % 3 == 0 ? Vec3d{unit(random), unit(random), 0}
                              : Vec3d{unit(random), unit(random), 1 + unit(random) / 2});
    PointSpread spread;
    ASSERT_EQ(obvious_issue(points, ShapeKind::plane, 3, spread), FitIssue::none);
    const WorkingPoints working = working_points(points, spread, 1);
    SampleNormals normals(working);
    std::vector<double> quality;
    for (std::size_t i = 0; i < working.size(); ++i) quality.push_back(normals.unevenness(i));
    std::vector<double> sorted = quality;
    std::sort(sorted.begin(), sorted.end());
    SampleDraw draw(working, normals, 3, true, 5);
    std::size_t part = 3, twice = 0;
    double until = 1, expected = 20000;
    for (std::size_t i = 0; i < 3; ++i) expected *= double(3 - i) / double(900 - i);
    std::size_t sample[3];
    for (int drawn = 1; drawn <= 3000; ++drawn) {
        if (drawn > until) {
            const double next = expected * double(part + 1) / double(part + 1 - 3);
            ++part;
            until += std::ceil(next - expected);
            expected = next;
        }
        if (!draw.draw(sample)) {
            ++twice;
            continue;
        }
        ASSERT_EQ(std::set<std::size_t>(sample, sample + 3).size(), 3u);
        ASSERT_EQ(quality[sample[0]], sorted[part - 1]) << "the newest of the part";
        for (const std::size_t s : sample) ASSERT_LE(quality[s], sorted[part - 1]);
        ASSERT_LT(part, 900u);
    }
    EXPECT_GT(part, 100u);
    EXPECT_LT(twice, 1000u);
    // The greatest share among the first ones, of fifty or more.
    std::vector<std::size_t> order(900);
    for (std::size_t i = 0; i < 900; ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return std::tie(quality[a], a) < std::tie(quality[b], b); });
    const auto on_plane = [&](std::size_t i) { return points.z[working.index[i]] == 0; };
    double best = 0.1, near = 0;
    for (std::size_t i = 0; i < part; ++i) {
        near += on_plane(order[i]);
        if (i + 1 >= 50) best = std::max(best, near / double(i + 1));
    }
    EXPECT_EQ(draw.share(0.1, on_plane), best);
    EXPECT_EQ(draw.share(1, on_plane), 1);
    EXPECT_GT(best, 0.5) << "the plane's points are the even ones";
}

TEST(SampleDraws, WithoutAnOrderAllAreAlike)
{
    const FitPoints points = box_of_points(10, {}, {1, 1, 1});
    PointSpread spread;
    ASSERT_EQ(obvious_issue(points, ShapeKind::plane, 3, spread), FitIssue::none);
    const WorkingPoints working = working_points(points, spread, 1);
    SampleNormals normals(working);
    SampleDraw draw(working, normals, 3, false, 5);
    std::map<std::size_t, int> counts;
    int good = 0;
    for (int i = 0; i < 20000; ++i) {
        std::size_t sample[3];
        if (!draw.draw(sample)) continue;
        ++good;
        for (const std::size_t s : sample) ++counts[s];
    }
    EXPECT_NEAR(good, 20000 * 0.72, 300) << "10 * 9 * 8 of 1000";
    ASSERT_EQ(counts.size(), 10u);
    for (const auto& [point, count] : counts) EXPECT_NEAR(count, good * 0.3, 300) << point;
    EXPECT_EQ(draw.share(0.25, [](std::size_t) { return true; }), 0.25);
}

// The ends of all edges: all other points are to the left of a -> b, or on it between them.
std::set<std::uint32_t> corners_of(const FlatPoints& flat)
{
    std::set<std::uint32_t> corners;
    if (flat.size() == 1) corners.insert(0u);
    const auto between = [](std::int32_t v, std::int32_t from, std::int32_t to) {
        return v >= std::min(from, to) && v <= std::max(from, to);
    };
    for (std::uint32_t a = 0; a < flat.size(); ++a)
        for (std::uint32_t b = 0; b < flat.size(); ++b) {
            const bool edge =
                a != b && std::all_of(flat.points().begin(), flat.points().end(), [&](const FlatPoint& p) {
                    const std::int64_t turn = turn_of(flat[a], flat[b], p);
                    return turn > 0 ||
                           (turn == 0 && between(p.x, flat[a].x, flat[b].x) && between(p.y, flat[a].y, flat[b].y));
                });
            if (edge) corners.insert({a, b});
        }
    return corners;
}

// The minimum area of the rectangles along each edge.
double least_area(const std::vector<Vec2d>& hull)
{
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
        const double edge = std::hypot(b[0] - a[0], b[1] - a[1]);
        const Vec2d d{(b[0] - a[0]) / edge, (b[1] - a[1]) / edge};
        double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
        for (const Vec2d& p : hull) {
            const double along[2] = {p[0] * d[0] + p[1] * d[1], p[1] * d[0] - p[0] * d[1]};
            for (int n = 0; n < 2; ++n) low[n] = std::min(low[n], along[n]), high[n] = std::max(high[n], along[n]);
        }
        least = std::min(least, (high[0] - low[0]) * (high[1] - low[1]));
    }
    return least;
}

// A rectangle of that area, counter-clockwise, with all points in it.
void expect_least_rectangle(const std::vector<Vec2d>& hull)
{
    const std::vector<Vec2d> rectangle = least_rectangle(hull);
    ASSERT_EQ(rectangle.size(), 4u);
    const auto side = [&](std::size_t i) {
        const Vec2d &a = rectangle[i], &b = rectangle[(i + 1) % 4];
        return Vec2d{b[0] - a[0], b[1] - a[1]};
    };
    const double least = least_area(hull);
    EXPECT_NEAR(side(0)[0] * side(1)[1] - side(0)[1] * side(1)[0], least, 1e-9 * least);
    for (std::size_t i = 0; i < 4; ++i)
        for (const Vec2d& p : hull)
            EXPECT_GE(side(i)[0] * (p[1] - rectangle[i][1]) - side(i)[1] * (p[0] - rectangle[i][0]), -1e-6);
}

TEST(FlatPoints, HullsAndLeastRectanglesAreThoseOfAllPairs)
{
    std::mt19937_64 random(3);
    for (int round = 0; round < 60; ++round) {
        const std::size_t count = 1 + random() % 40;
        const int range = round % 3 == 0 ? 4 : 1000;
        std::vector<Vec2d> points;
        for (std::size_t i = 0; i < count; ++i)
            points.push_back({double(int(random() % range)), round % 7 == 0 ? 5.0 : double(int(random() % range))});
        const FlatPoints flat(points);
        // Each place once, in order, with the first of its points.
        std::map<std::pair<double, double>, std::uint32_t> places;
        for (std::size_t i = 0; i < count; ++i) places.try_emplace({points[i][0], points[i][1]}, std::uint32_t(i));
        ASSERT_EQ(flat.size(), places.size());
        std::size_t k = 0;
        for (const auto& [place, index] : places) {
            EXPECT_EQ(flat[k].index, index);
            EXPECT_NEAR(flat[k].x * flat.step(), place.first - points[flat[0].index][0], 1e-6);
            ++k;
        }
        const std::vector<std::uint32_t> hull = flat.convex_hull();
        EXPECT_EQ(std::set<std::uint32_t>(hull.begin(), hull.end()), corners_of(flat));
        EXPECT_EQ(hull.size(), corners_of(flat).size()) << "each once";
        std::vector<Vec2d> corners;
        for (std::size_t i = 0; i < hull.size(); ++i) {
            corners.push_back(points[flat[hull[i]].index]);
            if (hull.size() < 3) continue;
            EXPECT_GT(turn_of(flat[hull[i]], flat[hull[(i + 1) % hull.size()]], flat[hull[(i + 2) % hull.size()]]), 0);
        }
        if (hull.size() < 3)
            EXPECT_TRUE(least_rectangle(corners).empty());
        else
            expect_least_rectangle(corners);
    }
    EXPECT_EQ(FlatPoints({}).size(), 0u);
    EXPECT_TRUE(FlatPoints({}).convex_hull().empty());
    const FlatPoints one({{3, 4}, {3, 4}});
    EXPECT_EQ(one.size(), 1u);
    EXPECT_EQ(one.step(), 0);
}

}  // namespace
