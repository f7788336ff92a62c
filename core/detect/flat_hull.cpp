#include "pcm/detect/flat_hull.h"

#include "pcm/cloud/numbers.h"
#include "pcm/shapes/flat_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pcm {

FlatHull::FlatHull(const std::vector<Vec3d>& points, const Shape& plane) : point_(plane.point), frame_(plane.axis)
{
    std::vector<Vec2d> flat;
    for (const Vec3d& p : points) flat.push_back({dot(p - point_, frame_.u), dot(p - point_, frame_.v)});
    const FlatPoints sorted(flat);
    for (const std::uint32_t i : sorted.convex_hull()) corners_.push_back(flat[sorted[i].index]);
}

double FlatHull::area() const
{
    double twice = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Vec2d &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return std::fabs(twice) / 2;
}

double FlatHull::gap_to(const FlatHull& other) const
{
    double gap = -infinity;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Vec2d &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
        const double dx = b[0] - a[0], dy = b[1] - a[1], side = std::hypot(dx, dy);
        double least = infinity;
        for (const Vec2d& p : other.corners_) least = std::min(least, ((p[0] - a[0]) * dy - (p[1] - a[1]) * dx) / side);
        gap = std::max(gap, least);
    }
    return gap;
}

double FlatHull::gap_to(const Vec2d& p) const
{
    if (corners_.size() < 3) return infinity;
    double gap = -infinity;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Vec2d &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
        const double dx = b[0] - a[0], dy = b[1] - a[1];
        gap = std::max(gap, ((p[0] - a[0]) * dy - (p[1] - a[1]) * dx) / std::hypot(dx, dy));
    }
    return gap;
}

}  // namespace pcm
