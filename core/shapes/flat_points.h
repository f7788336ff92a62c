// Points of a plane on a fine grid of integers, on which all turns are exact: hulls, rectangles, triangulations.
#pragma once

#include "pcm/cloud/polygon.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

struct FlatPoint {
    std::int32_t x, y;    // 0 to FlatPoints::steps
    std::uint32_t index;  // number of the given point; the first of several at one place
};

// Points in the order of x, then y, each place once. The grid divides the larger extent by 2^30, so that hulls and
// outlines are right to a billionth of the points' extent. Immutable.
class FlatPoints {
public:
    // Finite, at most 2^32 - 1. O(n log n).
    explicit FlatPoints(const std::vector<Vec2d>& points);

    const std::vector<FlatPoint>& points() const { return points_; }
    std::size_t size() const { return points_.size(); }
    const FlatPoint& operator[](std::size_t i) const { return points_[i]; }
    double step() const { return step_; }  // step of the grid; 0 where all points are at one place

    // Places in points() of the corners of the convex hull, counter-clockwise, none on the line between its neighbours.
    // Two places, or one, where all points are on one line.
    std::vector<std::uint32_t> convex_hull() const;

    static constexpr std::int32_t steps = 1 << 30;

private:
    std::vector<FlatPoint> points_;
    double step_ = 0;
};

// Twice the area of the triangle a, b, c, in squares of the grid: above 0 where it turns counter-clockwise. Exact.
inline std::int64_t turn_of(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c)
{
    const auto difference = [](std::int32_t p, std::int32_t q) {
        return static_cast<std::int64_t>(p) - static_cast<std::int64_t>(q);
    };
    return difference(b.x, a.x) * difference(c.y, a.y) - difference(b.y, a.y) * difference(c.x, a.x);
}

// The rectangle of least area around a convex polygon that turns counter-clockwise, by rotating calipers (Toussaint
// 1983): four corners, counter-clockwise; none for fewer than three. O(n).
std::vector<Vec2d> least_rectangle(const std::vector<Vec2d>& hull);

}  // namespace pcm
