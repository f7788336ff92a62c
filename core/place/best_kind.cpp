#include "pcm/place/best_kind.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

constexpr double inlier_noises = 3;   // an inlier's largest distance
constexpr double far_less = 0.3;      // noise
constexpr double as_little = 1.25;    // times the noise of the surface: nothing is left to explain,
constexpr double half_less = 0.45;    // where it is less than half of what there was
constexpr double least_share = 0.5;   // of the points
constexpr double most_radius = 200;   // of the other kind, in the noise: what is less bent may be a scanner's error
constexpr std::size_t enough = 3000;  // points to compare kinds
const double gain_on_plane = std::log(2.0), gain_on_curved = std::log(1.2);  // per inlier, of a kind of higher rank

int rank_of(ShapeKind kind)
{
    return kind == ShapeKind::plane ? 0 : kind == ShapeKind::cylinder || kind == ShapeKind::sphere ? 1 : 2;
}

std::size_t sample_of(ShapeKind kind)
{
    switch (kind) {
        case ShapeKind::plane:
            return 3;
        case ShapeKind::sphere:
            return 4;
        case ShapeKind::cylinder:
            return 5;
        case ShapeKind::cone:
            return 6;
        case ShapeKind::torus:
            return 7;
    }
    return 0;
}

// Of a shape's bend near a place; infinite for a plane.
double radius_at(const Shape& shape, const Vec3d& place)
{
    switch (shape.kind) {
        case ShapeKind::plane:
            break;
        case ShapeKind::cylinder:
        case ShapeKind::sphere:
            return shape.radius;
        case ShapeKind::cone:
            return length(cross(place - shape.point, shape.axis)) / std::cos(shape.second);
        case ShapeKind::torus:
            return shape.second;
    }
    return std::numeric_limits<double>::infinity();
}

}  // namespace

double log_false_alarms(std::size_t points, std::size_t inliers, std::size_t sample, double part)
{
    if (inliers <= sample || points <= sample) return 0;
    const auto choose = [](double n, double k) {
        return std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1);
    };
    const auto n = static_cast<double>(points), k = static_cast<double>(inliers), m = static_cast<double>(sample);
    return std::log(n - m) + choose(n, k) + choose(k, m) + (k - m) * std::log(std::clamp(part, 1e-12, 1.0));
}

double chance_of(const ShapeFit& fit, const FitPoints& points, double depth)
{
    const double distance = fit.noise > 0 ? std::min(fit.threshold, inlier_noises * fit.noise) : fit.threshold;
    std::size_t inliers = 0;
    for (std::size_t i = 0; i < points.size(); ++i) inliers += distance_to(fit.shape, points.source(i)) <= distance;
    return log_false_alarms(points.size(), inliers, sample_of(fit.shape.kind), depth > 0 ? distance / depth : 1);
}

bool is_determined(const ShapeFit& fit)
{
    return fit.verdict == FitVerdict::good || (fit.has_shape() && fit.issue == FitIssue::not_converged);
}

std::optional<std::size_t> best_of(const std::vector<ShapeFit>& fits, const FitPoints& points, double depth)
{
    const bool any_good = std::any_of(fits.begin(), fits.end(), is_determined);
    std::optional<std::size_t> best;
    double least = 0;
    for (int rank = 0; rank <= 2; ++rank) {
        std::optional<std::size_t> of_rank;
        double least_of_rank = 0;
        for (std::size_t k = 0; k < fits.size(); ++k) {
            const bool takes_part = any_good ? is_determined(fits[k]) : fits[k].has_shape();
            if (!takes_part || rank_of(fits[k].shape.kind) != rank) continue;
            const double chance = chance_of(fits[k], points, depth);
            if (of_rank && chance >= least_of_rank) continue;
            of_rank = k;
            least_of_rank = chance;
        }
        if (!of_rank) continue;
        if (best) {
            const double gain = rank_of(fits[*best].shape.kind) == 0 ? gain_on_plane : gain_on_curved;
            if (!(least_of_rank + gain * static_cast<double>(fits[*of_rank].inliers) < least)) continue;
        }
        best = of_rank;
        least = least_of_rank;
    }
    return best;
}

std::optional<ShapeKind> better_kind(const ShapeFit& fit, const std::vector<Vec3d>& points, double noise,
                                     const ProgressFunction& progress)
{
    std::vector<Vec3d> inliers;
    for (const Vec3d& p : points)
        if (distance_to(fit.shape, p) <= fit.threshold) inliers.push_back(p);
    const std::size_t every = 1 + inliers.size() / enough;
    std::vector<Vec3d> some;
    for (std::size_t i = 0; i < inliers.size(); i += every) some.push_back(inliers[i]);
    const FitPoints compared = FitPoints::of(some);
    ShapeFitOptions options;
    options.threshold = 2 * inlier_noises * noise;
    options.progress = progress;
    std::optional<ShapeKind> best;
    double least = std::max(far_less * fit.noise, std::min(as_little * noise, half_less * fit.noise));
    for (const ShapeTraits& row : shape_kinds()) {
        options.kind = row.kind;
        if (row.kind == fit.shape.kind || !(options.threshold > 0)) continue;
        const ShapeFit other = fit_shape(compared, options);
        if (!is_determined(other) ||
            static_cast<double>(other.inliers) < least_share * static_cast<double>(some.size()) ||
            !(other.noise < least))
            continue;
        if (fit.shape.kind == ShapeKind::plane && !(radius_at(other.shape, some.front()) < most_radius * fit.noise))
            continue;
        best = row.kind;
        least = other.noise;
    }
    return best;
}

}  // namespace pcm
