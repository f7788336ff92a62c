#include "pcm/detect/surface_of_both.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/hypotheses.h"
#include "pcm/detect/refined_shape.h"
#include "pcm/detect/tuning.h"
#include "pcm/fit/pipe_start.h"
#include "pcm/shapes/flat_hull.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// Every second point, from this one on.
std::vector<Vec3d> every_second(const std::vector<Vec3d>& points, std::size_t first)
{
    std::vector<Vec3d> some;
    for (std::size_t i = first; i < points.size(); i += 2) some.push_back(points[i]);
    return some;
}

struct Pair {
    const PartSurface &one, &other;
    double threshold() const { return std::max(one.threshold, other.threshold); }
    std::vector<Vec3d> all_points() const
    {
        std::vector<Vec3d> all = one.points;
        all.insert(all.end(), other.points.begin(), other.points.end());
        return all;
    }
};

// Those of both parts, each fitted by itself, and of half of the points of both.
struct PairFits {
    ShapeFit first, second;
    Shape both;
    // Greater rms distance of a part's points from its own shape.
    double own_rms(const Pair& pair) const
    {
        return std::max(rms_distance(first.shape, pair.one.points), rms_distance(second.shape, pair.other.points));
    }
};

std::optional<PairFits> fits_of(const Pair& pair)
{
    const double threshold = pair.threshold();
    if (!(rms_distance(pair.one.shape, pair.other.points) <= 4 * threshold)) return std::nullopt;
    PairFits fits;
    fits.first = refined_fit(pair.one.points, pair.one.shape, 1.5 * threshold);
    fits.second = refined_fit(pair.other.points, pair.other.shape, 1.5 * threshold);
    if (!fits.first.has_shape() || !fits.second.has_shape()) return std::nullopt;
    std::vector<Vec3d> half = every_second(pair.one.points, 0);
    for (const Vec3d& p : every_second(pair.other.points, 0)) half.push_back(p);
    const auto both = refined_shape(half, pair.one.shape, 6 * threshold);
    if (!both) return std::nullopt;
    fits.both = *both;
    return fits;
}

// Whether points that a surface was not fitted to lie on it as on their own.
bool are_on(const Shape& surface, const Pair& pair, double most_rms)
{
    return rms_distance(surface, every_second(pair.one.points, 1)) <= most_rms &&
           rms_distance(surface, every_second(pair.other.points, 1)) <= most_rms;
}

bool have_most_of_hull(const Shape& plane, const Pair& pair, double most_gap)
{
    const FlatHull first(pair.one.points, plane), second(pair.other.points, plane);
    return std::max(first.gap_to(second), second.gap_to(first)) <= most_gap &&
           first.area() + second.area() >=
               detect_tuning().joining.min_filled * FlatHull(pair.all_points(), plane).area();
}

std::optional<Shape> plane_of_both(const Pair& pair, const PartJoinOptions& options)
{
    const auto fits = fits_of(pair);
    if (!fits) return std::nullopt;
    const double least = std::cos(std::min(options.normal_angle, pi / 2));
    if (std::fabs(dot(fits->second.shape.axis, fits->both.axis)) < least) return std::nullopt;
    const double share = std::min(detect_tuning().joining.max_rms,
                                  detect_tuning().contest.min_noise * options.noise / options.threshold);
    const double most = std::min(detect_tuning().merging.same_rms * fits->own_rms(pair), share * pair.threshold());
    if (!are_on(fits->both, pair, most)) return std::nullopt;
    if (!have_most_of_hull(fits->both, pair, detect_tuning().joining.max_gap * options.spacing)) return std::nullopt;
    return fits->both;
}

bool have_most_of_length(const Vec3d& axis, const Pair& pair)
{
    const double own = extent_along(axis, pair.one.points) + extent_along(axis, pair.other.points);
    return own >= detect_tuning().joining.min_filled * extent_along(axis, pair.all_points());
}

std::optional<Shape> cylinder_of_both(const Pair& pair, const PartJoinOptions& options)
{
    if (!pair.one.is_small && !pair.other.is_small) return std::nullopt;
    const auto fits = fits_of(pair);
    if (!fits || !have_most_of_length(fits->both.axis, pair)) return std::nullopt;
    const double apart = std::fabs(fits->first.shape.radius - fits->second.shape.radius);
    const double error = std::hypot(fits->first.errors.radius, fits->second.errors.radius);
    if (!(apart <= detect_tuning().joining.max_errors * error)) return std::nullopt;
    const double most = std::min(detect_tuning().merging.same_rms * fits->own_rms(pair),
                                 detect_tuning().contest.min_noise * options.noise);
    if (!are_on(fits->both, pair, most)) return std::nullopt;
    return fits->both;
}

}  // namespace

bool can_be_joined(ShapeKind kind) { return traits_of(kind).is_flat() || kind == ShapeKind::cylinder; }

double most_gap(ShapeKind kind, double extent, const PartJoinOptions& options)
{
    // The cylinder with more points, to which the other one is joined, is rarely the shorter.
    return traits_of(kind).is_flat() ? detect_tuning().joining.max_gap * options.spacing
                                     : 2 * extent * (1 / detect_tuning().joining.min_filled - 1);
}

std::optional<Shape> surface_of_both(const PartSurface& one, const PartSurface& other, const PartJoinOptions& options)
{
    if (one.shape.kind != other.shape.kind) return std::nullopt;
    if (traits_of(one.shape.kind).is_flat()) return plane_of_both({one, other}, options);
    return one.shape.kind == ShapeKind::cylinder ? cylinder_of_both({one, other}, options) : std::nullopt;
}

}  // namespace pcm
