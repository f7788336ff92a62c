#include "pcm/detect/shape_growth.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/tuning.h"
#include "pcm/fit/shape_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t refit_points = 1500;  // maximum for another fit of a shape while it grows

}  // namespace

bool fits(const SurfaceSample& sample, std::size_t point, const Shape& shape, double threshold, double cos_angle)
{
    const Vec3d& p = sample.at[point];
    return distance_to(shape, p) <= threshold &&
           std::fabs(dot(sample.normal_of(point), normal_at(shape, p))) >= cos_angle;
}

std::vector<std::uint32_t> ShapeGrowth::patch(std::uint32_t seed, std::size_t most, double cos_angle)
{
    ++stamp_;
    std::vector<std::uint32_t> points{seed};
    seen_[seed] = stamp_;
    const Vec3d normal = sample_.normal_of(seed);
    for (std::size_t next = 0; next < points.size() && points.size() < most; ++next) {
        const std::uint32_t* const near = sample_.neighbours(points[next]);
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours && points.size() < most; ++k) {
            const std::uint32_t j = near[k];
            if (seen_[j] == stamp_ || taken_[j]) continue;
            seen_[j] = stamp_;
            if (std::fabs(dot(sample_.normal_of(j), normal)) >= cos_angle) points.push_back(j);
        }
    }
    return points;
}

// Least squares of some of the points; false where they determine no shape.
bool ShapeGrowth::refit(Shape& shape, const std::vector<std::uint32_t>& points, double threshold) const
{
    FitPoints some;
    const std::size_t step = std::max<std::size_t>(1, points.size() / refit_points);
    for (std::size_t i = 0; i < points.size(); i += step) some.add(sample_.at[points[i]]);
    RefineOptions refine;
    refine.threshold = 1.5 * threshold;
    refine.most_steps = 8;
    const ShapeFit fit = refine_shape(some, shape, refine);
    if (!fit.has_shape() || !is_finite(fit.shape.point)) return false;
    shape = fit.shape;
    return true;
}

std::vector<std::uint32_t> ShapeGrowth::reach(Shape& shape, const std::vector<std::uint32_t>& from,
                                              const GrowthLimits& limits, bool refits)
{
    ++stamp_;
    const auto fits_here = [&](std::uint32_t i) { return fits(sample_, i, shape, limits.threshold, limits.cos_angle); };
    std::vector<std::uint32_t> points;
    for (const std::uint32_t i : from)
        if (seen_[i] != stamp_ && fits_here(i)) {
            seen_[i] = stamp_;
            points.push_back(i);
        }
    std::size_t fitted = points.size();
    for (std::size_t next = 0; next < points.size(); ++next) {
        if (refits && points.size() >= 2 * fitted) {
            if (!refit(shape, points, limits.threshold)) return {};
            fitted = points.size();
        }
        const std::uint32_t* const near = sample_.neighbours(points[next]);
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
            const std::uint32_t j = near[k];
            if (seen_[j] == stamp_ || taken_[j] || !fits_here(j)) continue;
            seen_[j] = stamp_;
            points.push_back(j);
        }
    }
    return points;
}

FoundShape ShapeGrowth::grow(Shape shape, const std::vector<std::uint32_t>& from, const GrowthLimits& limits)
{
    FoundShape found;
    if (!refit(shape, from, limits.threshold)) return found;
    std::vector<std::uint32_t> points = reach(shape, from, limits, true);
    for (int round = 0; round < 3 && points.size() >= limits.least; ++round) {
        const std::size_t before = points.size();
        if (!refit(shape, points, limits.threshold)) return found;
        points = reach(shape, points, limits, false);
        if (points.size() <= before + before / 50) break;
    }
    if (points.size() < limits.least) return found;
    double squares = 0;
    for (const std::uint32_t i : points) {
        const double d = signed_distance(shape, sample_.at[i]);
        squares += d * d;
    }
    found.rms = std::sqrt(squares / static_cast<double>(points.size()));
    found.shape = shape;
    found.points = std::move(points);
    found.threshold = limits.threshold;
    return found;
}

FoundShape ShapeGrowth::grow_around(const FoundShape& pipe, const GrowthLimits& limits)
{
    double low = infinity, high = -infinity;
    for (const std::uint32_t i : pipe.points) {
        const double along = dot(sample_.at[i] - pipe.shape.point, pipe.shape.axis);
        low = std::min(low, along);
        high = std::max(high, along);
    }
    Box3d box;
    for (const double along : {low, high}) box.extend(sample_.origin + pipe.shape.point + along * pipe.shape.axis);
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] -= pipe.shape.radius + limits.threshold;
        box.max[a] += pipe.shape.radius + limits.threshold;
    }
    std::vector<std::uint32_t> around;
    for_points_near(sample_, box, pipe.shape, limits.threshold, [&](std::uint32_t i) {
        const double along = dot(sample_.at[i] - pipe.shape.point, pipe.shape.axis);
        if (!taken_[i] && along >= low && along <= high && fits(sample_, i, pipe.shape, limits.threshold, -1))
            around.push_back(i);
    });
    return grow(pipe.shape, around, limits);
}

void ShapeGrowth::take(const FoundShape& found, const GrowthLimits& limits)
{
    const double shadow = detect_tuning().search.shadow * found.threshold;
    for (const std::uint32_t i : found.points) taken_[i] = 1;
    std::vector<std::uint32_t> open = found.points;
    while (!open.empty()) {
        const std::uint32_t* const near = sample_.neighbours(open.back());
        open.pop_back();
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
            const std::uint32_t j = near[k];
            if (taken_[j] || !fits(sample_, j, found.shape, shadow, limits.cos_angle)) continue;
            taken_[j] = 1;
            open.push_back(j);
        }
    }
}

}  // namespace pcm
