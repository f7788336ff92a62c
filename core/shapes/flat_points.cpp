#include "pcm/shapes/flat_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

std::vector<Vec2d> rectangle_along(const Vec2d& d, const std::vector<Vec2d>& points)
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec2d low{infinity, infinity}, high{-infinity, -infinity};
    for (const Vec2d& p : points) {
        const Vec2d turned{p[0] * d[0] + p[1] * d[1], p[1] * d[0] - p[0] * d[1]};
        for (std::size_t k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], turned[k]);
            high[k] = std::max(high[k], turned[k]);
        }
    }
    const auto place = [&](double x, double y) { return Vec2d{x * d[0] - y * d[1], x * d[1] + y * d[0]}; };
    return {place(low[0], low[1]), place(high[0], low[1]), place(high[0], high[1]), place(low[0], high[1])};
}

}  // namespace

FlatPoints::FlatPoints(const std::vector<Vec2d>& points)
{
    if (points.empty()) return;
    Vec2d low = points.front(), high = low;
    for (const Vec2d& p : points)
        for (std::size_t k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    const double extent = std::max(high[0] - low[0], high[1] - low[1]);
    const double per_length = extent > 0 ? steps / extent : 0;
    step_ = extent / steps;
    const auto snapped = [&](double value, std::size_t k) {
        return static_cast<std::int32_t>(std::lround(std::min<double>((value - low[k]) * per_length, steps)));
    };
    points_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        points_.push_back({snapped(points[i][0], 0), snapped(points[i][1], 1), static_cast<std::uint32_t>(i)});
    std::sort(points_.begin(), points_.end(), [](const FlatPoint& a, const FlatPoint& b) {
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.index < b.index;
    });
    const auto same = [](const FlatPoint& a, const FlatPoint& b) { return a.x == b.x && a.y == b.y; };
    points_.erase(std::unique(points_.begin(), points_.end(), same), points_.end());
}

// Andrew's monotone chain (1979).
std::vector<std::uint32_t> FlatPoints::convex_hull() const
{
    std::vector<std::uint32_t> hull;
    const std::size_t count = points_.size();
    if (count < 3) {
        for (std::uint32_t i = 0; i < count; ++i) hull.push_back(i);
        return hull;
    }
    for (const bool upper : {false, true}) {
        const std::size_t begin = hull.size();
        for (std::size_t i = 0; i < count; ++i) {
            const auto next = static_cast<std::uint32_t>(upper ? count - 1 - i : i);
            while (hull.size() >= begin + 2 &&
                   turn_of(points_[hull[hull.size() - 2]], points_[hull.back()], points_[next]) <= 0)
                hull.pop_back();
            hull.push_back(next);
        }
        hull.pop_back();
    }
    return hull;
}

std::vector<Vec2d> least_rectangle(const std::vector<Vec2d>& hull)
{
    const std::size_t count = hull.size();
    if (count < 3) return {};
    const auto along = [&](std::size_t i, const Vec2d& d) { return hull[i][0] * d[0] + hull[i][1] * d[1]; };
    // The corner farthest along d, from `i` onwards.
    const auto farthest = [&](std::size_t i, const Vec2d& d) {
        for (std::size_t moved = 0; moved < count; ++moved, i = (i + 1) % count)
            if (along((i + 1) % count, d) <= along(i, d)) break;
        return i;
    };
    Vec2d best{1, 0};
    double least = std::numeric_limits<double>::infinity();
    std::size_t right = 0, top = 0, left = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2d &a = hull[i], &b = hull[(i + 1) % count];
        const double edge = std::hypot(b[0] - a[0], b[1] - a[1]);
        if (!(edge > 0)) continue;
        const Vec2d d{(b[0] - a[0]) / edge, (b[1] - a[1]) / edge}, n{-d[1], d[0]};
        right = farthest(i == 0 ? 1 : right, d);
        top = farthest(i == 0 ? right : top, n);
        left = farthest(i == 0 ? top : left, {-d[0], -d[1]});
        const double area = (along(right, d) - along(left, d)) * (along(top, n) - along(i, n));
        // Sides that differ by rounding alone leave the first one.
        if (!(area < least * (1 - 1e-12))) continue;
        least = area;
        best = d;
    }
    return rectangle_along(best, hull);
}

}  // namespace pcm
