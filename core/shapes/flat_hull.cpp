#include "pcm/shapes/flat_hull.h"

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
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Vec2d &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
        const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
        sides_.push_back({a, {(b[1] - a[1]) / length, (a[0] - b[0]) / length}});
    }
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
    for (const Side& side : sides_) {
        double least = infinity;
        for (const Vec2d& p : other.corners_) least = std::min(least, side.gap_to(p));
        gap = std::max(gap, least);
    }
    return gap;
}

double FlatHull::gap_to(const Vec2d& p) const
{
    if (corners_.size() < 3) return infinity;
    double gap = -infinity;
    for (const Side& side : sides_) gap = std::max(gap, side.gap_to(p));
    return gap;
}

double width_of(const std::vector<Vec3d>& outline)
{
    double width = infinity;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec3d& from = outline[i];
        const Vec3d along = outline[(i + 1) % outline.size()] - from;
        if (!(length(along) > 0)) continue;
        double most = 0;
        for (const Vec3d& p : outline) most = std::max(most, length(cross(p - from, normalised(along))));
        width = std::min(width, most);
    }
    return width;
}

}  // namespace pcm
