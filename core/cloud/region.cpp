// Which points a region contains, and the relation of boxes to it.
#include "pcm/cloud/region.h"

#include "pcm/cloud/numbers.h"
#include "pcm/cloud/vector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pcm {
namespace {

// The smallest and the largest a . d over a box; both are at corners, because dot() is monotonic.
std::pair<double, double> range(const Vec3d& a, const Box3d& d)
{
    Vec3d low, high;
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = a[k] > 0 ? d.min[k] : d.max[k];
        high[k] = a[k] > 0 ? d.max[k] : d.min[k];
    }
    return {dot(a, low), dot(a, high)};
}

// For the numbers from low to high: the one nearest to 0, and the distance of the farthest from 0.
double nearest_to_zero(double low, double high) { return low > 0 ? low : high < 0 ? high : 0.0; }
double farthest_from_zero(double low, double high) { return std::max(std::fabs(low), std::fabs(high)); }

double value(const Region::Plane& row, const Vec3d& d) { return dot(row.normal, d) + row.offset; }
double largest_coordinate(const Vec2d& v) { return std::max(std::fabs(v[0]), std::fabs(v[1])); }

}  // namespace

bool Region::radial_contains(const Vec3d& d) const
{
    const double t = dot(axis_, d);
    if (!(t >= 0 && t <= length_)) return false;
    const Vec3d w = d - t * axis_;
    if (kind_ == Kind::cone) return std::sqrt(dot(w, w)) * cosine_ <= t * sine_;
    if (!(largest_magnitude(w) <= radius_)) return false;
    const Vec3d v = inverse_unit_ * w;
    return dot(v, v) <= scaled_square_;
}

bool Region::contains(const Vec3d& p) const
{
    if (kind_ == Kind::box) return is_finite(p) && box_.contains(p);
    const Vec3d d = p - centre_;
    if (!is_finite(d)) return false;
    switch (kind_) {
        case Kind::oriented_box:
        case Kind::convex:
            for (const Plane& plane : planes_)
                if (!(dot(plane.normal, d) + plane.offset >= 0)) return false;
            return true;
        case Kind::sphere: {
            if (!(largest_magnitude(d) <= radius_)) return false;
            const Vec3d v = inverse_unit_ * d;
            return dot(v, v) <= scaled_square_;
        }
        case Kind::polygon: {
            for (const Plane& plane : planes_)
                if (!(dot(plane.normal, d) + plane.offset >= 0)) return false;
            const double w = value(rows_[2], d);
            return w > 0 && polygon_->contains(value(rows_[0], d) / w, value(rows_[1], d) / w);
        }
        default:
            return radial_contains(d);
    }
}

std::optional<std::vector<Region::Plane>> Region::half_spaces() const
{
    if (kind_ == Kind::oriented_box || kind_ == Kind::convex) return planes_;
    if (kind_ != Kind::box) return std::nullopt;
    std::vector<Plane> planes;
    for (std::size_t a = 0; a < 3; ++a) {
        Plane least, most;
        least.normal[a] = 1;
        least.offset = centre_[a] - box_.min[a];
        most.normal[a] = -1;
        most.offset = box_.max[a] - centre_[a];
        for (const Plane& plane : {least, most})
            if (plane.offset != std::numeric_limits<double>::infinity()) planes.push_back(plane);
    }
    return planes;
}

BoxRelation Region::half_space(const Plane& plane, const Box3d& d)
{
    const auto [low, high] = range(plane.normal, d);
    if (high + plane.offset < 0) return BoxRelation::outside;
    return low + plane.offset >= 0 ? BoxRelation::inside : BoxRelation::crosses;
}

// f(d) = |d - t u| cos - t sin is convex, so its largest value in a box is at a corner. A lower bound: f(d) >= g . d
// with g = cos (v - (v . u) u) - sin u for every unit vector v; a tight one has v pointing from the axis to the box.
BoxRelation Region::radial_relation(const Box3d& d) const
{
    const auto [first, last] = range(axis_, d);
    if (last < 0 || first > length_) return BoxRelation::outside;
    double reach = 0;
    {
        Vec3d far;
        for (std::size_t a = 0; a < 3; ++a) far[a] = farthest_from_zero(d.min[a], d.max[a]);
        reach = length(far);
    }
    const double margin = 32 * unit_roundoff * reach;
    if (!std::isfinite(reach)) return BoxRelation::crosses;
    const double limit = kind_ == Kind::ray ? radius_ : 0;

    std::array<std::array<double, 2>, 8> corners;  // projected along the axis
    bool inside = first >= 0 && last <= length_;
    for (std::size_t i = 0; i < 8; ++i) {
        const Vec3d corner = {i & 1 ? d.max[0] : d.min[0], i & 2 ? d.max[1] : d.min[1], i & 4 ? d.max[2] : d.min[2]};
        corners[i] = {dot(across_[0], corner), dot(across_[1], corner)};
        const double t = dot(axis_, corner);
        const Vec3d w = corner - t * axis_;
        inside = inside && length(w) * cosine_ - t * sine_ <= limit - margin - 8 * unit_roundoff * limit;
    }
    if (inside) return BoxRelation::inside;

    const auto separates = [&](double x, double y) {
        const double length = std::hypot(x, y);
        if (!(length > 0)) return false;
        Vec3d v;
        for (std::size_t a = 0; a < 3; ++a)
            v[a] = (x / length * across_[0][a] + y / length * across_[1][a]) * (1 - 8 * unit_roundoff);
        const double tilt = cosine_ * dot(v, axis_) + sine_;
        const Vec3d g = cosine_ * v - tilt * axis_;
        return range(g, d).first > limit + margin + 8 * unit_roundoff * limit;
    };
    for (std::size_t i = 0; i < 8; ++i) {
        if (separates(corners[i][0], corners[i][1])) return BoxRelation::outside;
        for (const std::size_t bit : {1u, 2u, 4u}) {
            if (i & bit) continue;
            // The point of the edge nearest to the axis.
            const auto &a = corners[i], &b = corners[i | bit];
            const double x = b[0] - a[0], y = b[1] - a[1], square = x * x + y * y;
            const double s = square > 0 ? std::clamp(-(a[0] * x + a[1] * y) / square, 0.0, 1.0) : 0.0;
            if (s > 0 && s < 1 && separates(a[0] + s * x, a[1] + s * y)) return BoxRelation::outside;
        }
    }
    return BoxRelation::crosses;
}

// The projections of a box's points lie in the convex hull of those of its corners. Where no edge comes near that, all
// are on the same side of the border.
BoxRelation Region::polygon_relation(const Box3d& d) const
{
    BoxRelation relation = BoxRelation::inside;
    for (const Plane& plane : planes_) relation = both(relation, half_space(plane, d));
    if (relation == BoxRelation::outside) return relation;
    std::array<double, 3> error{};  // largest rounding error of each row's value, for all points of the box
    for (std::size_t r = 0; r < 3; ++r) {
        const Plane& row = rows_[r];
        for (std::size_t a = 0; a < 3; ++a)
            error[r] += std::fabs(row.normal[a]) * farthest_from_zero(d.min[a], d.max[a]);
        error[r] = 8 * unit_roundoff * (error[r] + std::fabs(row.offset));
    }
    std::vector<Vec2d> corners(8);
    double least_w = std::numeric_limits<double>::infinity(), reach = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        const Vec3d corner = {i & 1 ? d.max[0] : d.min[0], i & 2 ? d.max[1] : d.min[1], i & 4 ? d.max[2] : d.min[2]};
        const double w = value(rows_[2], corner);
        least_w = std::min(least_w, w);
        for (std::size_t k = 0; k < 2; ++k) {
            corners[i][k] = value(rows_[k], corner) / w;
            reach = std::max(reach, std::fabs(corners[i][k]));
        }
    }
    if (!(least_w > 4 * error[2]) || !std::isfinite(reach)) return BoxRelation::crosses;
    const double margin = 4 * ((std::max(error[0], error[1]) + reach * error[2]) / least_w +
                               unit_roundoff * (reach + std::max(largest_coordinate(polygon_->min()),
                                                                 largest_coordinate(polygon_->max())))) +
                          1e-140;
    if (polygon_->border_touches(corners, margin)) return BoxRelation::crosses;
    return polygon_->contains(corners[0][0], corners[0][1]) ? relation : BoxRelation::outside;
}

BoxRelation Region::relation(const Box3d& box) const
{
    if (box.empty() || !bounds_.intersects(box)) return BoxRelation::outside;
    if (kind_ == Kind::box) {
        const bool finite = is_finite(box.min) && is_finite(box.max);
        return finite && box_.contains(box) ? BoxRelation::inside : BoxRelation::crosses;
    }
    // p - centre, rounded, is monotonic in p: these are the bounds of what contains() works on.
    const Box3d d{box.min - centre_, box.max - centre_};
    if (!is_finite(d.min) || !is_finite(d.max)) return BoxRelation::crosses;
    switch (kind_) {
        case Kind::oriented_box:
        case Kind::convex: {
            BoxRelation relation = BoxRelation::inside;
            for (const Plane& plane : planes_) relation = both(relation, half_space(plane, d));
            return relation;
        }
        case Kind::polygon:
            return polygon_relation(d);
        case Kind::sphere: {
            // Rounded squares and sums are monotonic too, so a sphere is classified exactly.
            Vec3d near, far;
            for (std::size_t a = 0; a < 3; ++a) {
                near[a] = nearest_to_zero(d.min[a], d.max[a]);
                far[a] = farthest_from_zero(d.min[a], d.max[a]);
            }
            const auto holds = [&](const Vec3d& v) {
                const Vec3d s = inverse_unit_ * v;
                return largest_magnitude(v) <= radius_ && dot(s, s) <= scaled_square_;
            };
            return !holds(near) ? BoxRelation::outside : holds(far) ? BoxRelation::inside : BoxRelation::crosses;
        }
        default:
            return radial_relation(d);
    }
}

double Region::along(const Vec3d& p) const { return dot(axis_, p - centre_); }

double Region::least_along(const Box3d& box) const
{
    return range(axis_, {box.min - centre_, box.max - centre_}).first;
}

}  // namespace pcm
