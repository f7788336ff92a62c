// Polygons in space and in plan: area, and whether they cross themselves.
#pragma once

#include "pcm/cloud/polygon.h"
#include "pcm/cloud/vector.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

// Twice the signed area of the triangle: positive where a, b, c turn counter-clockwise, and 0 only where rounding
// hides the sign. Exact to some units in the last place of the differences b - a and c - a.
double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c);

// The vector area of a closed polygon (the last point is joined with the first) is 1/2 sum(p[i] x p[i + 1]), relative
// to the first point.
Vec3d vector_area(const std::vector<Vec3d>& polygon);

// Two edges that meet where they are not neighbours, or neighbours that run back on each other; edge i begins at point
// i. Takes time by the square of the number of points.
struct EdgePair {
    std::size_t first, second;
};
std::optional<EdgePair> find_crossing(const std::vector<Vec2d>& polygon);

// The same polygon without points that repeat the one before.
std::vector<Vec3d> without_repeats(const std::vector<Vec3d>& polygon);

// Seen from above, and seen along a normal (unit) whose direction it looks against.
std::vector<Vec2d> in_plan(const std::vector<Vec3d>& polygon);
std::vector<Vec2d> seen_along(const std::vector<Vec3d>& polygon, const Vec3d& normal);

}  // namespace pcm
