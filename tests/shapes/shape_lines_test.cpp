#include "pcm/shapes/shape_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pcm {
namespace {

struct Case {
    const char* text;
    ShapeBounds bounds;
};

ShapeBounds length_of(double from, double to)
{
    ShapeBounds bounds;
    bounds.from = from;
    bounds.to = to;
    return bounds;
}

ShapeBounds arc_of(double from, double to, double begin, double end)
{
    ShapeBounds bounds = length_of(from, to);
    bounds.zero = {1, 0, 0};
    bounds.begin = begin;
    bounds.end = end;
    return bounds;
}

ShapeBounds outline_of(const std::vector<Vec3d>& corners)
{
    ShapeBounds bounds;
    bounds.outline = corners;
    return bounds;
}

std::vector<Case> cases()
{
    return {{"plane 1 2 3 0 0 1", outline_of({{0, 0, 3}, {4, 0, 3}, {4, 2, 3}})},
            {"cylinder 1 2 3 1 1 1 0.25", length_of(-2, 5)},
            {"cylinder 1 2 3 0 0 1 0.25", arc_of(0, 1, 0.5, 2)},
            {"sphere 1 2 3 7", {}},
            {"cone 1 2 3 0 0 1 30", length_of(0, 2)},
            {"cone 1 2 3 0 1 0 30", length_of(1, 2)},
            {"torus 1 2 3 0 0 1 2 0.5", {}},
            {"torus 1 2 3 0 0 1 2 0.5", arc_of(0, 0, 1, 2.5)}};
}

TEST(ShapeLines, LieOnTheSurface)
{
    for (const Case& each : cases()) {
        const Shape shape = parse_shape(each.text);
        const auto lines = shape_lines(shape, each.bounds);
        ASSERT_GE(lines.size(), 2u) << each.text;
        std::size_t axes = 0;
        for (const ShapeLine& line : lines) {
            axes += line.is_axis;
            ASSERT_GE(line.points.size(), 2u) << each.text;
            for (const Vec3d& p : line.points)
                if (!line.is_axis) EXPECT_LT(distance_to(shape, p), 1e-12) << each.text;
        }
        EXPECT_EQ(axes, shape.kind == ShapeKind::sphere ? 0u : 1u) << each.text;
    }
}

TEST(ShapeLines, SegmentsKeepTheChord)
{
    for (const Case& each : cases())
        for (const double chord : {0.0, 0.01}) {
            const Shape shape = parse_shape(each.text);
            const double largest = std::max(shape.radius + shape.second, 2.0);
            const double allowed = chord > 0 ? chord : largest / 500;
            for (const ShapeLine& line : shape_lines(shape, each.bounds, {chord})) {
                if (line.is_axis) continue;
                for (std::size_t i = 1; i < line.points.size(); ++i)
                    EXPECT_LE(distance_to(shape, 0.5 * (line.points[i] + line.points[i - 1])), allowed * 1.0001)
                        << each.text;
            }
        }
}

TEST(ShapeLines, ReachTheEndsAndNoFarther)
{
    const Shape shape = parse_shape("cylinder 1 2 3 0 0 1 0.25");
    double least = 1e9, most = -1e9, first = 1e9, last = -1e9;
    for (const ShapeLine& line : shape_lines(shape, arc_of(-1, 2, 0.5, 2))) {
        if (line.is_axis) continue;
        EXPECT_FALSE(line.closed);
        for (const Vec3d& p : line.points) {
            const double angle = std::atan2(p[1] - 2, p[0] - 1);
            least = std::min(least, p[2]);
            most = std::max(most, p[2]);
            first = std::min(first, angle);
            last = std::max(last, angle);
        }
    }
    EXPECT_DOUBLE_EQ(least, 2);
    EXPECT_DOUBLE_EQ(most, 5);
    EXPECT_NEAR(first, 0.5, 1e-12);
    EXPECT_NEAR(last, 2, 1e-12);
}

TEST(ShapeLines, WholeCirclesAreClosed)
{
    std::size_t closed = 0;
    for (const ShapeLine& line : shape_lines(parse_shape("cylinder 0 0 0 0 0 1 1"), length_of(0, 1))) {
        closed += line.closed;
        if (line.closed) EXPECT_GT(squared_distance(line.points.front(), line.points.back()), 1e-4);
    }
    EXPECT_EQ(closed, 3u);
}

TEST(ShapeLines, EachLineIsDrawnOnce)
{
    // Three parallels and four meridians.
    EXPECT_EQ(shape_lines(parse_shape("sphere 1 2 3 7"), {}).size(), 7u);
    // No circle at the apex, and nothing beyond it: two circles, eight lines, the axis.
    for (const double from : {0.0, -3.0}) {
        const auto lines = shape_lines(parse_shape("cone 0 0 0 0 0 1 30"), length_of(from, 2));
        EXPECT_EQ(lines.size(), 11u);
        for (const ShapeLine& line : lines)
            for (const Vec3d& p : line.points)
                if (!line.is_axis) EXPECT_GE(p[2], 0);
    }
}

TEST(ShapeLines, AnAxisIsSeenBeyondTheEnds)
{
    const ShapeLine axis = shape_lines(parse_shape("cylinder 0 0 0 0 0 1 1"), length_of(0, 10)).back();
    EXPECT_TRUE(axis.is_axis);
    EXPECT_EQ(axis.points, (std::vector<Vec3d>{{0, 0, -0.5}, {0, 0, 10.5}}));
}

TEST(ShapeLines, NothingIsDrawnOfWhatIsNotKnown)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(shape_lines(parse_shape("plane 0 0 0 0 0 1"), {}).empty());
    EXPECT_TRUE(shape_lines(parse_shape("cylinder 0 0 0 0 0 1 1"), length_of(1, 1)).empty());
    EXPECT_TRUE(box_of(parse_shape("cylinder 0 0 0 0 0 1 1"), length_of(1, 1)).empty());
    Shape broken = parse_shape("sphere 0 0 0 1");
    broken.radius = nan;
    EXPECT_TRUE(shape_lines(broken, {}).empty());
    broken = parse_shape("sphere 0 0 0 1");
    broken.point[1] = nan;
    EXPECT_TRUE(shape_lines(broken, {}).empty());
    EXPECT_TRUE(shape_lines(parse_shape("torus 0 0 0 0 0 1 2 1"), arc_of(0, 0, 0, nan)).empty());
}

TEST(ShapeLines, ABoxHoldsTheWholeSurface)
{
    const Shape shape = parse_shape("torus 1 2 3 0 0 1 2 0.5");
    const Box3d box = box_of(shape, {});
    for (int i = 0; i < 1000; ++i) {
        const double u = i * 0.37, v = i * 0.11;
        const double q = shape.radius + shape.second * std::cos(v);
        EXPECT_TRUE(box.contains(Vec3d{1 + q * std::cos(u), 2 + q * std::sin(u), 3 + shape.second * std::sin(v)}));
    }
    EXPECT_LT(box.diagonal(), 1.1 * std::hypot(5, 5, 1));
}

}  // namespace
}  // namespace pcm
