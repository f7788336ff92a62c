#include "pcm/place/best_kind.h"

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/error_agreement.h"
#include "pcm/place/tuning.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

int rank_of(ShapeKind kind) { return model_of(kind).rank; }
int rank_of(const ShapeFit& fit) { return rank_of(fit.shape.kind); }

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

double KindComparison::misfit(const Shape& shape) const
{
    const double most = std::pow(fit_tuning().thresholds.inlier_noises, 2);
    double sum = 0;
    for (std::size_t i = 0; i < points_.size(); i += every_) {
        const double d = distance_to(shape, points_.source(i)) / noise_;
        sum += std::min(d * d, most);
    }
    return sum * static_cast<double>(every_) / 2;
}

double KindComparison::agreement(const Shape& shape) const
{
    const double limit = fit_tuning().thresholds.inlier_noises * noise_;
    ErrorAgreement errors(box_.min, box_.diagonal() / place_tuning().kinds.agreement_cubes);
    for (std::size_t i = 0; i < points_.size(); i += every_) {
        const double d = signed_distance(shape, points_.source(i));
        if (std::fabs(d) <= limit) errors.add(points_.source(i), d);
    }
    return errors.factor();
}

double KindComparison::evidence(const Shape& shape, const Shape& simpler) const
{
    const KindTuning& tuned = place_tuning().kinds;
    const auto n = static_cast<double>(points_.size());
    const double shared = agreement(shape), independent = std::max(n / (shared * shared), 2.0);
    const double more = static_cast<double>(model_of(shape.kind).parameters()) -
                        static_cast<double>(model_of(simpler.kind).parameters());
    const double gain = std::log(rank_of(simpler.kind) == 0 ? tuned.gain_on_plane : tuned.gain_on_curved);
    const double won = misfit(simpler) - misfit(shape);
    return std::min(won - gain * n, won / (shared * shared) - more / 2 * std::log(independent) - tuned.min_evidence);
}

KindComparison::KindComparison(const FitPoints& points, double noise)
    : points_(points), noise_(noise), every_(1 + points.size() / enough_compared)
{
    for (std::size_t i = 0; i < points.size(); i += every_) box_.extend(points.source(i));
}

std::vector<Vec3d> points_of_both(const std::vector<Vec3d>& points, const ShapeFit& one, const ShapeFit& other)
{
    std::vector<Vec3d> both;
    for (const Vec3d& p : points)
        if (distance_to(one.shape, p) <= one.threshold && distance_to(other.shape, p) <= other.threshold)
            both.push_back(p);
    return both;
}

bool explains_better(const ShapeFit& fit, const Shape& simpler, const std::vector<Vec3d>& points)
{
    const FitPoints compared = FitPoints::of(points);
    return fit.noise > 0 && KindComparison(compared, fit.noise).evidence(fit.shape, simpler) > 0;
}

KindChoice choose_kind(const std::vector<ShapeFit>& fits, const FitPoints& points)
{
    KindChoice choice;
    const bool any_good = std::any_of(fits.begin(), fits.end(), is_determined);
    const auto is_considered = [&](const ShapeFit& fit) { return any_good ? is_determined(fit) : fit.has_shape(); };
    double noise = infinity;
    std::uint64_t most = 0;
    for (const ShapeFit& fit : fits)
        if (is_considered(fit)) most = std::max(most, fit.inliers);
    for (const ShapeFit& fit : fits)
        if (is_considered(fit) && 2 * fit.inliers >= most)
            noise = std::min(noise, fit.noise > 0 ? std::min(fit.noise, fit.threshold) : fit.threshold);
    if (!(noise > 0 && noise < infinity)) noise = 1e-9;
    const KindComparison compared(points, noise);
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < fits.size(); ++k)
        if (is_considered(fits[k])) order.push_back(k);
    std::vector<double> misfit(fits.size(), infinity);
    for (const std::size_t k : order) misfit[k] = compared.misfit(fits[k].shape);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::make_pair(rank_of(fits[a]), misfit[a]) < std::make_pair(rank_of(fits[b]), misfit[b]);
    });
    for (const std::size_t k : order) {
        if (!choice.best) {
            choice.best = k;
        } else if (rank_of(fits[k]) > rank_of(fits[*choice.best]) &&
                   compared.evidence(fits[k].shape, fits[*choice.best].shape) > 0) {
            choice.next = choice.best;
            choice.best = k;
        } else if (!choice.next || misfit[k] < misfit[*choice.next]) {
            choice.next = k;
        }
    }
    if (choice.next) choice.log_ratio = misfit[*choice.next] - misfit[*choice.best];
    return choice;
}

std::optional<ShapeKind> better_kind(const ShapeFit& fit, const std::vector<Vec3d>& points, double noise,
                                     const ProgressFunction& progress)
{
    std::vector<Vec3d> inliers;
    for (const Vec3d& p : points)
        if (distance_to(fit.shape, p) <= fit.threshold) inliers.push_back(p);
    const std::size_t every = 1 + inliers.size() / enough_compared;
    std::vector<Vec3d> sample;
    for (std::size_t i = 0; i < inliers.size(); i += every) sample.push_back(inliers[i]);
    const FitPoints compared = FitPoints::of(sample);
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
            static_cast<double>(other.inliers) < tuned.min_share * static_cast<double>(sample.size()) ||
            !(other.noise < least))
            continue;
        const double radius = row.bend_radius(other.shape, sample.front());
        if (traits_of(fit.shape.kind).is_flat() && !(radius < tuned.max_radius * fit.noise)) continue;
        best = row.kind;
        least = other.noise;
    }
    return best;
}

}  // namespace pcm
