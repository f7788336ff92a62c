#include "pcm/fit/shape_fit.h"

#include "pcm/fit/chance_test.h"
#include "pcm/fit/least_squares.h"
#include "pcm/fit/local_support.h"
#include "pcm/fit/pcl_fit.h"
#include "pcm/fit/shape_search.h"
#include "pcm/fit/tuning.h"
#include "pcm/fit/working_points.h"
#include "pcm/system/error.h"
#include "pcm/system/seconds.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace pcm {
namespace {

constexpr double fine_tolerance = 1e-7;  // steps of a three-thousandth of the errors are the last ones

using Clock = std::chrono::steady_clock;

[[noreturn]] void refuse_options(const std::string& what) { throw Error(ErrorCode::invalid_argument, {}, what); }

void check(const ShapeFitOptions& options)
{
    if (!(options.threshold >= 0 && std::isfinite(options.threshold)))
        refuse_options("the threshold is below 0 or not finite");
    if (!(options.probability > 0 && options.probability < 1)) refuse_options("the probability is not between 0 and 1");
    if (options.iterations == 0) refuse_options("the number of iterations is 0");
    if (!(options.seconds >= 0)) refuse_options("the time limit is below 0");
    if (!(options.least_radius >= 0 && options.largest_radius > options.least_radius))
        refuse_options("the largest radius is not above the least");
    if (!(options.normal_angle > 0)) refuse_options("the angle between normals is not above 0");
}

ShapeFit refused(ShapeKind kind, FitIssue issue)
{
    const std::string name = traits_of(kind).name;
    ShapeFit fit;
    fit.shape.kind = kind;
    fit.issue = issue;
    switch (issue) {
        case FitIssue::too_few_points:
            fit.message = "fewer points than a " + name + " needs: take a larger neighbourhood";
            break;
        case FitIssue::not_finite:
            fit.message = "a coordinate is NaN or infinite";
            break;
        case FitIssue::coincident:
            fit.message = "all points are at one place";
            break;
        case FitIssue::collinear:
            fit.message = "all points are on one line: take points off that line";
            break;
        case FitIssue::coplanar:
            fit.message = "all points are in one plane: fit a plane, or take points farther around the " + name;
            break;
        default:
            fit.message = "no " + name + " has enough points: raise the threshold or the number of iterations";
    }
    return fit;
}

// With a threshold within the noise, least squares of the points up to it is less exact than of those up to here.
double widened(double threshold, double noise)
{
    const ThresholdTuning& tuned = fit_tuning().thresholds;
    return std::clamp(tuned.polish_noises * noise, threshold, tuned.max_polish_widening * threshold);
}

// Which points least squares took at last, and how many of those within the threshold are there by chance.
struct UsedBand {
    PatchBand band;
    double chance = 0;
    std::optional<LocalSupport> support;  // support that the band points to
};

// From a sample's shape: by points within the threshold first, then without those that are near it by chance.
PolishedPatch polished_sample(const ShapeModel& model, const Shape& start, const WorkingPoints& working, UsedBand& used,
                              unsigned most_steps)
{
    constexpr double coarse_tolerance = 0.01;  // steps of a tenth of the errors
    PatchBand& band = used.band;
    const double threshold = band.threshold;
    PolishedPatch polished = polish(model, model.patch_at(start, {}), working, band, 10, coarse_tolerance);
    // Few such points that weigh no more than others do no harm.
    const BandFacts facts = band_facts(model, polished, working, threshold);
    used.chance = facts.chance;
    const ConsensusTuning& tuned = fit_tuning().consensus;
    if (facts.chance < tuned.harmless_chance && facts.influence < tuned.harmless_influence) {
        band.threshold = widened(threshold, polished.noise());
        band.share = 1 - facts.chance * band.threshold / threshold;
        band.deviation = polished.noise();
        return polish(model, polished.patch, working, band, most_steps, fine_tolerance);
    }
    LocalSupport& support = used.support.emplace(model, working);
    for (int round = 0; round < 2; ++round) {
        band.threshold = widened(threshold, polished.noise());
        const Shape shape = model.shape_of(polished.patch);
        const bool changed = support.find(shape, band.threshold, polished.noise());
        if (round > 0 && !changed) break;
        band.support = support.of_points();
        band.share = support.share();
        polished =
            polish(model, model.patch_at(shape, {}), working, band, round == 0 ? 10 : most_steps, coarse_tolerance);
    }
    polished = polish(model, polished.patch, working, band, most_steps, fine_tolerance);
    used.chance = band_facts(model, polished, working, threshold).chance;
    return polished;
}

// A least-squares fit of a cylinder that is almost a plane may end with its axis across: other directions are tried.
void try_other_axes(const ShapeModel& model, const WorkingPoints& working, const PatchBand& band, unsigned most_steps,
                    PolishedPatch& polished)
{
    const SurfacePatch from = polished.patch;
    for (const double turn : {0.5, 0.25, 0.75}) {
        SurfacePatch start = from;
        models::turn(start, (turn * pi) * from.n);
        start.curvature = 0.01;
        const PolishedPatch other = polish(model, start, working, band, most_steps, fine_tolerance);
        if (other.sums.cost < polished.sums.cost) polished = other;
    }
}

// Errors grow where those of neighbours are correlated.
void judge_scatter(const ShapeModel& model, const PolishedPatch& polished, const WorkingPoints& working,
                   const UsedBand& used, ShapeFit& fit)
{
    if (!is_nearly_flat(fit, model.shape_of(polished.patch), polished.sums)) return;
    std::array<double, most_parameters * most_parameters> scatter{};
    if (scatter_of(model, polished.patch, working, used.band, polished.mixture, scatter))
        fit = judged(model, polished.patch, polished.sums, polished.noise(), {}, 1, scatter.data());
    const ConsensusTuning& tuned = fit_tuning().consensus;
    if (polished.noise() > tuned.max_flat_noise * used.band.threshold || used.chance > tuned.max_flat_chance)
        doubt(
            fit, FitIssue::thin_arc,
            "the threshold is within the noise of points that are almost a plane, so the size is uncertain: raise the "
            "threshold, or take points farther around the shape");
}

// Which points are within the threshold, and their rms.
void mark_inliers(const Shape& shape, const WorkingPoints& working, const PatchBand& band, ShapeFit& fit)
{
    const ShapeModel& model = model_of(shape.kind);
    const BlockLoops& loops = block_loops();
    fit.is_inlier.assign(working.size(), 0);
    double inliers = 0, squares = 0;
    PatchBlock block;
    BlockWeights weights;
    for (std::size_t first = 0; first < working.size(); first += patch_block) {
        const std::size_t count = std::min(patch_block, working.size() - first);
        model.distances(shape, &working.x[first], &working.y[first], &working.z[first], count, block.distance);
        inliers += loops.within(block, count, band.threshold, weights);
        inliers -= take_away_other_normals(shape, working, band.least_cosine, first, count, weights.within);
        for (std::size_t k = 0; k < count; ++k) fit.is_inlier[working.index[first + k]] = weights.within[k] > 0;
        squares += loops.squares(block, weights, count);
    }
    fit.inliers = static_cast<std::uint64_t>(inliers);
    fit.rms = fit.inliers > 0 ? std::sqrt(squares / static_cast<double>(fit.inliers)) * working.unit : 0;
}

// Polished with all points, judged, in source units, with its inliers.
ShapeFit finished(const WorkingPoints& working, const Shape& start, const PatchBand& band, unsigned most_steps,
                  bool sample)
{
    const ShapeModel& model = model_of(start.kind);
    UsedBand used{band, 0, {}};
    PolishedPatch polished = sample
                                 ? polished_sample(model, start, working, used, most_steps)
                                 : polish(model, model.patch_at(start, {}), working, band, most_steps, fine_tolerance);
    ShapeFit fit = judged(model, polished.patch, polished.sums, polished.noise(), {}, 1);
    if (sample && model.flat_starts > 1 && fit.issue != FitIssue::none) {
        try_other_axes(model, working, used.band, most_steps, polished);
        fit = judged(model, polished.patch, polished.sums, polished.noise(), {}, 1);
    }
    if (sample) judge_scatter(model, polished, working, used, fit);
    if (!polished.converged)
        doubt(fit, FitIssue::not_converged, "least squares did not converge: the errors may be larger");
    if (used.chance > fit_tuning().consensus.max_chance)
        doubt(fit, FitIssue::no_consensus,
              std::string("almost as many points are next to the ") + model.traits.name +
                  " as on it, so it may be there by chance: raise the number of iterations, or the threshold where the "
                  "noise is larger");
    const Shape shape = model.shape_of(polished.patch);
    fit.shape = working.to_source(shape);
    fit.threshold = band.threshold;
    to_source_units(fit, working.unit);
    mark_inliers(shape, working, band, fit);
    return fit;
}

bool radius_in_range(const Shape& shape, const ShapeFitOptions& options)
{
    const double radius = narrowest_radius(shape);
    return !traits_of(shape.kind).has_radius() || (radius >= options.least_radius && radius <= options.largest_radius);
}

double cosine_of(double normal_angle) { return normal_angle < pi / 2 ? std::cos(normal_angle) : -1; }

// Search and least squares with a threshold that is given or found, in working units.
class Fitting {
public:
    Fitting(const WorkingPoints& working, const SearchOptions& search, double smallest)
        : working_(working), search_(search), model_(model_of(search.fit.kind)), smallest_(smallest), on_(search.on)
    {
        search_.on = [this](double fraction) { return on_(done_ + part_ * fraction); };
    }
    Fitting(const Fitting&) = delete;

    ShapeFit fit_within(double threshold)
    {
        search_.threshold = threshold;
        const SearchResult found = search_shape(working_, search_);
        samples_ += found.samples;
        return found.found ? refitted(found.shape, threshold) : refused(model_.kind(), FitIssue::no_consensus);
    }

    // Points that are few for their outliers show more than their noise, and a wide band finds no surface:
    // searches this threshold, its half and so on for the one whose points are least likely to be there by chance.
    ShapeFit fit_from(double threshold)
    {
        const ChanceTest test(working_);
        Found best;
        for (unsigned k = 0; k <= most_halved; ++k, threshold /= 2) {
            part_ = 0.5 * (1 - done_);
            Found found = settled(test, fit_within(threshold));
            const bool narrow = found.share < tuned_.narrow_share;
            const bool better = k == 0 || found.log_false_alarms < tuned_.min_improvement * best.log_false_alarms;
            if (better) best = std::move(found);
            if (is_sure(best) || narrow || threshold / 2 < smallest_) break;
            if (!better && best.log_false_alarms < tuned_.clear_log_false_alarms && best.share < tuned_.wide_share)
                break;
            done_ += part_;
            if (!on_(done_)) break;
        }
        judge(best);
        return std::move(best.fit);
    }

    std::uint64_t samples() const { return samples_; }

private:
    struct Found {
        ShapeFit fit;
        double share = 1, log_false_alarms = 0;  // see ChanceTest
    };
    static constexpr unsigned most_halved = 6;

    ShapeFit refitted(const Shape& start, double threshold)
    {
        ShapeFit fit = finished(working_, start, {threshold, cosine_of(search_.fit.normal_angle)}, 50, true);
        fit.threshold = threshold * working_.unit;
        return fit;
    }

    // Narrowed to the noise of the surface, and to where most of it is among others.
    Found settled(const ChanceTest& test, ShapeFit fit)
    {
        Found found{std::move(fit)};
        for (int round = 0; found.fit.has_shape(); ++round) {
            const Shape shape = working_.to_working(found.fit.shape);
            const double now = found.fit.threshold / working_.unit;
            const double dense = tuned_.dense_bands * test.best_threshold(model_, shape, now);
            const double noises = fit_tuning().thresholds.inlier_noises * found.fit.noise / working_.unit;
            const double better = std::max(std::min(noises, dense), smallest_);
            if (round == most_rounds || better > tuned_.settled_share * now) {
                found.share = test.share(model_, shape, now);
                found.log_false_alarms = test.log_alarms(model_, found.share, static_cast<double>(found.fit.inliers));
                break;
            }
            found.fit = refitted(shape, better);
        }
        return found;
    }
    static constexpr int most_rounds = 6;

    bool is_sure(const Found& found) const
    {
        const auto inliers = static_cast<double>(found.fit.inliers);
        const double others = static_cast<double>(working_.size()) - inliers;
        return found.log_false_alarms < 0 && found.share < tuned_.max_share &&
               others * found.share / (1 - found.share) < tuned_.few_by_chance * inliers;
    }

    void judge(Found& found) const
    {
        if (!found.fit.has_shape()) return;
        const std::string name = model_.traits.name;
        const bool even = found.fit.noise > tuned_.even_noise * found.fit.threshold;
        // Surfaces with a direction may lie across the points: a strip of these is evenly within the band.
        if (even && (found.share > tuned_.max_share ||
                     (model_.traits.has_axis() && found.log_false_alarms > tuned_.log_false_alarm_limit)))
            doubt(found.fit, FitIssue::no_consensus,
                  "the points within the automatic threshold are spread evenly over it, so the " + name +
                      " may lie across them: take more points or fewer outliers, or set the threshold");
        if (!(found.log_false_alarms < 0))
            doubt(found.fit, FitIssue::no_consensus,
                  "as many points would be near some " + name +
                      " by chance: take more points or fewer outliers, or set the threshold");
    }

    const WorkingPoints& working_;
    SearchOptions search_;
    const ShapeModel& model_;
    const HalvingTuning& tuned_ = fit_tuning().halving;
    double smallest_, done_ = 0, part_ = 1;
    std::function<bool(double)> on_;
    std::uint64_t samples_ = 0;
};

}  // namespace

const std::vector<EstimatorTraits>& estimators()
{
    static const std::vector<EstimatorTraits> rows{
        {Estimator::ransac, "ransac", "RANSAC", "most inliers"},
        {Estimator::msac, "msac", "MSAC", "least sum of squared distances, outliers count as the threshold"},
        {Estimator::mlesac, "mlesac", "MLESAC", "greatest likelihood of Gaussian noise and uniform outliers"},
        {Estimator::prosac, "prosac", "PROSAC", "MSAC; points whose neighbours lie in a plane are drawn first"},
        {Estimator::rransac, "rransac", "RRANSAC", "RANSAC; a sample is scored if another random point is near it"},
        {Estimator::rmsac, "rmsac", "RMSAC", "MSAC; a sample is scored if another random point is near it"},
    };
    return rows;
}

const EstimatorTraits& traits_of(Estimator estimator) { return estimators()[static_cast<std::size_t>(estimator)]; }

std::optional<Estimator> estimator_of(const std::string& name)
{
    for (const EstimatorTraits& row : estimators())
        if (name == row.name) return row.estimator;
    return {};
}

ShapeFit fit_shape(const FitPoints& points, const ShapeFitOptions& options)
{
    check(options);
    const Clock::time_point start = Clock::now();
    const ShapeModel& model = model_of(options.kind);
    PointSpread spread;
    const FitIssue issue = obvious_issue(points, options.kind, model.parameters(), spread);
    if (issue != FitIssue::none) return refused(options.kind, issue);
    if (options.backend == FitBackend::pcl) return pcl_fit(points, options);
    const WorkingPoints working = working_points(points, spread, options.seed);
    SearchOptions search{options, 0, {}};
    const double threshold = options.threshold > 0 ? options.threshold : automatic_threshold(points);
    search.threshold = threshold > 0 ? threshold / working.unit : fit_tuning().thresholds.unknown_noise;
    // No smaller than what rounded coordinates distinguish.
    const double smallest = std::max(1e-9, 8e-16 * largest_magnitude(working.middle) / working.unit);
    search.threshold = std::max(search.threshold, smallest);
    search.fit.least_radius /= working.unit;
    search.fit.largest_radius /= working.unit;
    search.on = [&](double fraction) {
        if (options.progress && !options.progress({"Fitting", fraction, -1}))
            throw Error(ErrorCode::cancelled, {}, "fitting was cancelled");
        return !(options.seconds > 0) || seconds_since(start) < options.seconds;
    };
    Fitting fitting(working, search, smallest);
    ShapeFit fit = options.threshold > 0 ? fitting.fit_within(search.threshold) : fitting.fit_from(search.threshold);
    if (fit.has_shape() && !radius_in_range(fit.shape, options)) {
        fit.verdict = FitVerdict::refused;
        fit.issue = FitIssue::out_of_range;
        fit.message = "the " + std::string(traits_of(options.kind).name) +
                      " of these points has a radius out of the range that was asked for: widen the range";
    }
    fit.iterations = fitting.samples();
    fit.seconds = seconds_since(start);
    return fit;
}

ShapeFit refine_shape(const FitPoints& points, const Shape& start, const RefineOptions& options)
{
    check(start);
    if (!(options.threshold > 0)) refuse_options("the threshold is not above 0");
    const Clock::time_point begin = Clock::now();
    PointSpread spread;
    const FitIssue issue = obvious_issue(points, start.kind, model_of(start.kind).parameters(), spread);
    if (issue != FitIssue::none) return refused(start.kind, issue);
    const WorkingPoints working = working_points(points, spread, 1);
    const PatchBand band{options.threshold / working.unit, cosine_of(options.normal_angle)};
    ShapeFit fit = finished(working, working.to_working(start), band, options.most_steps, false);
    fit.seconds = seconds_since(begin);
    return fit;
}

}  // namespace pcm
