#include "pcm/place/best_kind.h"

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/tuning.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t enough = 3000;  // points to compare kinds

int rank_of(const ShapeFit& fit) { return model_of(fit.shape.kind).rank; }

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
    const double noises = fit_tuning().thresholds.inlier_noises * fit.noise;
    const double distance = fit.noise > 0 ? std::min(fit.threshold, noises) : fit.threshold;
    std::size_t inliers = 0;
    for (std::size_t i = 0; i < points.size(); ++i) inliers += distance_to(fit.shape, points.source(i)) <= distance;
    return log_false_alarms(points.size(), inliers, model_of(fit.shape.kind).parameters(),
                            depth > 0 ? distance / depth : 1);
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
    int highest = 0;
    for (const ShapeFit& fit : fits) highest = std::max(highest, rank_of(fit));
    for (int rank = 0; rank <= highest; ++rank) {
        std::optional<std::size_t> of_rank;
        double least_of_rank = 0;
        for (std::size_t k = 0; k < fits.size(); ++k) {
            const bool takes_part = any_good ? is_determined(fits[k]) : fits[k].has_shape();
            if (!takes_part || rank_of(fits[k]) != rank) continue;
            const double chance = chance_of(fits[k], points, depth);
            if (of_rank && chance >= least_of_rank) continue;
            of_rank = k;
            least_of_rank = chance;
        }
        if (!of_rank) continue;
        if (best) {
            const KindTuning& tuned = place_tuning().kinds;
            const double gain = std::log(rank_of(fits[*best]) == 0 ? tuned.gain_on_plane : tuned.gain_on_curved);
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
    options.threshold = 2 * fit_tuning().thresholds.inlier_noises * noise;
    options.progress = progress;
    std::optional<ShapeKind> best;
    const KindTuning& tuned = place_tuning().kinds;
    const double enough_less = std::min(tuned.surface_noise * noise, tuned.half_noise * fit.noise);
    double least = std::max(tuned.far_less_noise * fit.noise, enough_less);
    for (const ShapeTraits& row : shape_kinds()) {
        options.kind = row.kind;
        if (row.kind == fit.shape.kind || !(options.threshold > 0)) continue;
        const ShapeFit other = fit_shape(compared, options);
        if (!is_determined(other) ||
            static_cast<double>(other.inliers) < tuned.min_share * static_cast<double>(some.size()) ||
            !(other.noise < least))
            continue;
        const double radius = row.bend_radius(other.shape, some.front());
        if (traits_of(fit.shape.kind).is_flat() && !(radius < tuned.max_radius * fit.noise)) continue;
        best = row.kind;
        least = other.noise;
    }
    return best;
}

}  // namespace pcm
