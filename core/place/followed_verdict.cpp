#include "pcm/place/followed_verdict.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/place/best_kind.h"
#include "pcm/place/cover_points.h"
#include "pcm/place/cut_out_evidence.h"
#include "pcm/place/inner_points.h"
#include "pcm/place/narrow_strip.h"
#include "pcm/place/near_bend.h"
#include "pcm/place/station_departure.h"
#include "pcm/place/station_sample.h"
#include "pcm/place/station_sides.h"
#include "pcm/place/tuning.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t most_judged = 20000;    // points that may be a cut-out of another surface
constexpr std::size_t most_compared = 1000;   // points for which kinds are compared
constexpr std::size_t most_departing = 4000;  // points that may leave the shape together
constexpr std::size_t most_bent = 1500;       // points that may show a bend near a place

// Whether neighbours might share fewer errors about a shape of another kind. Not where they share them about any smooth
// surface, as the departure shows for a sample: the factor of `points` points is larger, as there are more of them.
bool may_be_other_kind(const FollowedPoints& followed, const Departure& departure, std::uint64_t points)
{
    const FollowingTuning& tuned = place_tuning().following;
    if (!(followed.agreement > tuned.min_agreement) && departure.is_chance) return false;
    if (departure.points == 0) return true;
    const double more = static_cast<double>(points) / static_cast<double>(departure.points);
    const double left = std::sqrt(1 + (departure.agreement * departure.agreement - 1) * std::max(more, 1.0));
    return left <= std::max(tuned.max_other_agreement, tuned.less_agreement * followed.agreement);
}

// Share of the variance that lies between two equal groups of points, by the coefficient of bimodality b that they have
// together: a mixture of two normal distributions has the kurtosis 3 - 2 share^2, and b is its inverse.
double share_between(double b) { return std::sqrt(std::clamp((3 - 1 / b) / 2, 0.0, 1.0)); }

}  // namespace

void come_back(const std::string& why, FitIssue issue, FittedPrimitive& result)
{
    result.left_surface = why;
    doubt(result.primitive.fit, issue,
          "followed through the cloud it left the surface (" + why + "): these are the points around the place alone");
}

FollowedVerdict::FollowedVerdict(const PointCloud& cloud, const std::vector<Vec3d>& places, const FitAtOptions& options,
                                 const KnownErrors& known, StationsAround& around, const ProgressFunction& progress)
    : cloud_(cloud), places_(places), options_(options), known_(known), around_(around), progress_(progress)
{
}

void FollowedVerdict::judge(const FollowedPoints& followed, FittedPrimitive& result)
{
    ShapeFit& fit = result.primitive.fit;
    const bool was_good = fit.verdict == FitVerdict::good;
    if (result.points.empty() || (!was_good && fit.issue != FitIssue::other_surface)) return;
    // Straight pipes continue an elbow off the torus, and are not points of it.
    const auto own = [&](std::vector<Vec3d> points) {
        const auto is_other = [&](const Vec3d& p) { return followed.part && !followed.part->has(p); };
        points.erase(std::remove_if(points.begin(), points.end(), is_other), points.end());
        return points;
    };
    std::vector<Vec3d> around;
    if (was_good)
        around = own(coarse_points(followed.around, most_judged, options_.threads, part_of(progress_, 0.9, 0.94)));
    const std::vector<Vec3d> fitted =
        own(random_points(result.points, most_departing, options_.threads, part_of(progress_, 0.94, 0.94)));
    const bool is_automatic = options_.fit.threshold == 0;
    if (was_good && is_automatic) judge_noise(followed, around, fitted, result);
    if (was_good && fit.verdict == FitVerdict::good) return judge_kind(followed, around, fitted, result);
    if (is_automatic && fit.issue == FitIssue::other_surface) name_departure(followed, fitted, result);
}

// Points that keep to one smooth surface, with the noise of those at the place, are one surface: a wall of large
// radius leaves a plane to both sides, too.
void FollowedVerdict::name_departure(const FollowedPoints& followed, const std::vector<Vec3d>& fitted,
                                     FittedPrimitive& result)
{
    ShapeFit& fit = result.primitive.fit;
    const Departure departure = departure_of(fit.shape, fit.threshold, fitted);
    if (!departure.is_smooth(known_noise())) return;
    const Departure own = without_stations(departure, followed.part, result);
    if (own.is_smooth(known_noise())) doubt_uneven(own, result);
}

void FollowedVerdict::doubt_uneven(const Departure& departure, FittedPrimitive& result)
{
    result.departure = departure;
    ShapeFit& fit = result.primitive.fit;
    fit.verdict = FitVerdict::good;  // what it was doubted for is explained by that
    doubt(fit, FitIssue::uneven, departure.message(traits_of(fit.shape.kind).name));
}

void FollowedVerdict::judge_noise(const FollowedPoints& followed, const std::vector<Vec3d>& around,
                                  const std::vector<Vec3d>& fitted, FittedPrimitive& result)
{
    ShapeFit& fit = result.primitive.fit;
    const double noise = followed.part ? fit.noise : followed.noise;
    doubt_sides(noise, result);
    if (fit.verdict != FitVerdict::good) return;
    const SurfaceEvidence evidence = surface_evidence(fit.shape, spread_of(fit), resolution(), around);
    if (!evidence.is_one_surface() && !is_of_stations(noise, evidence, followed.part, result))
        return doubt(fit, FitIssue::other_surface, evidence.message());
    // Points of coarse levels lie to one side of a face: the four of a post have one peak of them, and two of all.
    const SurfaceEvidence of_all = surface_evidence(fit.shape, spread_of(fit), resolution(), fitted);
    if (of_all.has_two_peaks() && !is_of_stations(noise, of_all, followed.part, result))
        return doubt(fit, FitIssue::other_surface, of_all.message());
    if (is_far_above_close_noise(fit, noise, evidence.bend, result.near))
        return doubt(fit, FitIssue::other_surface,
                     "its points leave it by " + brief(noise) + ", those next to each other at the place by " +
                         brief(known_noise()) +
                         ": it may hold several surfaces, so take a smaller neighbourhood, or give "
                         "a threshold");
    if (fit.threshold > place_tuning().growth.raised_limit * result.local.threshold && !evidence.has_shared_errors())
        return doubt(fit, FitIssue::other_surface,
                     "its points leave it farther and farther the more of them there are, by " + brief(noise) +
                         " at last: it may be a piece of another surface, so take a smaller neighbourhood");
    cuts_noise_ = fit.noise > place_tuning().following.max_noise_share * fit.threshold;
    if (cuts_noise_)
        return doubt(fit, FitIssue::no_consensus,
                     "the threshold cuts the noise of its points, which may be those of another surface: give a "
                     "larger threshold, or take a smaller neighbourhood");
    if (!passes_places(fit, result.near))
        return doubt(fit, FitIssue::no_consensus,
                     "it does not pass through the place that was picked: pick another place of the surface");
}

void FollowedVerdict::doubt_sides(double noise, FittedPrimitive& result)
{
    ShapeFit& fit = result.primitive.fit;
    if (!traits_of(fit.shape.kind).is_flat() || !around_.are_named()) return;
    const double smooth = around_.survey().noise();
    if (!(noise > place_tuning().sides.min_noise * smooth)) return;
    const std::vector<PointOfStation> some = station_sample(result.points, around_.points(), most_departing,
                                                            options_.threads, part_of(progress_, 0.94, 0.94));
    const StationSides sides = station_sides(fit.shape, some);
    if (sides.are_two(smooth, stations().most_spread)) {
        stations_at_place_ = signed_distance(fit.shape, places_.front()) > sides.middle ? sides.above : sides.below;
        return doubt(fit, FitIssue::other_surface,
                     "some stations see it " + brief(sides.apart) +
                         " from where the others do, so it may lie between the two faces of a plate: pick a place "
                         "where one face has more points, or give a threshold");
    }
    doubt_rough(sides.within > 0 ? sides.within : noise, smooth, some, result);
}

// Stations that are apart do not explain what the points of each leave the plane by.
void FollowedVerdict::doubt_rough(double within, double smooth, const std::vector<PointOfStation>& some,
                                  FittedPrimitive& result) const
{
    ShapeFit& fit = result.primitive.fit;
    if (!(within > place_tuning().sides.max_within * smooth)) return;
    for (const std::vector<Vec3d>& points : {places_of(some), result.near.points.sources()})
        if (surface_evidence(fit.shape, spread_of(fit), resolution(), points).has_shared_errors()) return;
    doubt(fit, FitIssue::other_surface,
          "the points of each station leave it by " + brief(within) + ", those of smooth surfaces around by " +
              brief(smooth) +
              ": it may hold several surfaces, as pipes side by side, so take a smaller neighbourhood, or give a "
              "threshold");
}

void FollowedVerdict::judge_kind(const FollowedPoints& followed, const std::vector<Vec3d>& around,
                                 const std::vector<Vec3d>& fitted, FittedPrimitive& result)
{
    ShapeFit& fit = result.primitive.fit;
    const std::string name = traits_of(fit.shape.kind).name;
    const CutOutEvidence cut_out = cut_out_evidence(fit.shape, fit.threshold, around);
    const Departure departure = departure_of(fit.shape, fit.threshold, fitted);
    const bool is_automatic = options_.fit.threshold == 0;
    const double noise = followed.part ? fit.noise : followed.noise;
    if (is_automatic && may_be_other_kind(followed, departure, result.points.size()))
        find_other_kind(fit, followed.around);
    if (other_)
        other_doubt_ = std::string("a ") + traits_of(other_->shape.kind).name + " of noise " + brief(other_->noise) +
                       " is more probable here than this " + name + " of noise " + brief(followed.noise) + ": fit that";
    if (cut_out.is_cut_out(known_.close_noise > 0 ? noise / known_.close_noise : 0)) {
        doubt(fit, FitIssue::other_surface,
              "the surface continues smoothly next to these points, but off the " + name +
                  ": they are a ring or strip where it touches a surface of another kind; fit that");
    } else if (const auto other = far_better_kind(result, noise, around)) {
        doubt(
            fit, FitIssue::other_surface,
            std::string("a ") + traits_of(*other).name + " fits these points far better than a " + name + ": fit that");
    } else if (cut_out.is_by_chance()) {
        doubt(fit, FitIssue::no_consensus,
              "almost as many points are next to the " + name +
                  " as on it, so it may be there by chance: give a smaller neighbourhood, or a larger threshold "
                  "where the noise is larger");
    } else if (is_automatic && departure.is_dominant(std::hypot(known_noise(), stations().spread))) {
        doubt_uneven(departure, result);
    } else if (is_automatic && !departure.is_chance) {
        const Departure own = without_stations(departure, followed.part, result);
        const bool is_seen =
            departure.is_smooth(known_noise()) || own.share > place_tuning().departure.min_hidden_share;
        if (is_seen && own.is_smooth(known_noise()))
            doubt_uneven(own, result);
        else if (own.share > place_tuning().departure.max_share)
            doubt(fit, FitIssue::other_surface,
                  "the points leave the " + name + " together by " + brief(own.size) +
                      ", which shifts of the stations do not explain: it may hold several surfaces, so take a smaller "
                      "neighbourhood, or give a threshold");
    }
    if (is_automatic && fit.verdict == FitVerdict::good) doubt_others(followed, cut_out, departure, noise, fit);
    if (is_automatic && fit.verdict == FitVerdict::good) doubt_strip(followed, fitted, result);
    if (is_automatic && fit.verdict == FitVerdict::good) doubt_bent(followed, noise, result);
    if (is_automatic && fit.verdict == FitVerdict::good) doubt_equal_kind(fitted, fit);
    if (is_automatic && !other_) doubt_unsettled(followed, result);
}

// What is out of round by more than neighbours show of noise is doubted before, as that. Where no stations are known,
// errors that neighbours share may be the scanner's.
void FollowedVerdict::doubt_others(const FollowedPoints& followed, const CutOutEvidence& cut_out,
                                   const Departure& departure, double noise, ShapeFit& fit)
{
    const FollowingTuning& tuned = place_tuning().following;
    const double least_inner = cut_out.is_crossed() ? tuned.min_inner_share : tuned.min_inner_along;
    if (followed.inner_share < least_inner && fit.inliers < tuned.max_few_points)
        return doubt(fit, FitIssue::other_surface,
                     "nearly all of its few points lie next to points that leave it, so they may be a strip of another "
                     "surface: take a smaller neighbourhood, or give a threshold");
    // The closest points may be those of several surfaces; then smooth ones around have less noise.
    const double explained = std::hypot(std::min(known_noise(), around_.most_noise()), stations().spread);
    const double most = around_.are_named() ? tuned.max_shared_noise : tuned.max_unknown_noise;
    const bool may_be_bent = !around_.are_named() && !departure.is_chance;
    const bool is_shared = std::max(followed.agreement, departure.agreement) > tuned.max_other_agreement;
    if (explained > 0 && noise > most * explained && !may_be_bent && is_shared)
        return doubt(fit, FitIssue::other_surface,
                     "neighbouring points leave it together by " + brief(noise) +
                         ", which neither the noise at the place nor shifts of the stations explain: it may hold "
                         "several surfaces, so take a smaller neighbourhood, or give a threshold");
    // Planes may be rough. The faces of a post alternate about a cylinder, so neighbours do not show them.
    const bool is_flat = traits_of(fit.shape.kind).is_flat();
    if (around_.are_named() && !is_flat && noise > tuned.max_curved_noise * around_.surface_noise())
        doubt(fit, FitIssue::other_surface,
              "its points leave it by " + brief(noise) + ", those of smooth surfaces around by " +
                  brief(around_.survey().noise()) +
                  ": it may hold several surfaces, so take a smaller neighbourhood, or give a threshold");
}

// Points of the surfaces next to a narrow face lie on its plane, too, where these were left out of sight or are as
// many.
void FollowedVerdict::doubt_strip(const FollowedPoints& followed, const std::vector<Vec3d>& fitted,
                                  FittedPrimitive& result) const
{
    const bool is_bare = followed.inner_share >= place_tuning().growth.min_inner &&
                         result.reached.limit.clips.size() == options_.limit.clips.size();
    if (!is_bare) pcm::doubt_strip(fitted, result.primitive.fit);
}

// Near its tangent an elbow is closer to the cylinder of its pipe than the noise. A place is the pipe's only if the
// points show that it lies before the tangent; else it may belong to the elbow.
void FollowedVerdict::doubt_bent(const FollowedPoints& followed, double noise, FittedPrimitive& result)
{
    ShapeFit& fit = result.primitive.fit;
    const auto is_outside = [&](const Vec3d& place) { return followed.part && !followed.part->has(place); };
    if (std::any_of(places_.begin(), places_.end(), is_outside))
        return doubt(fit, FitIssue::other_surface,
                     "the place that was picked is at the end of the bend, or on the pipe behind it: pick a place "
                     "farther from where they meet");
    if (fit.shape.kind != ShapeKind::cylinder || !(noise > 0)) return;
    for (const Vec3d& place : places_) {
        const PipeAtPlace pipe{fit.shape, fit.threshold, noise, place};
        const double reach = reach_of_bends(pipe);
        const auto is_near = [&](const Vec3d& p) { return std::fabs(dot(p - place, fit.shape.axis)) <= reach; };
        const PointSet near = points_where(followed.around, is_near, options_.threads, part_of(progress_, 0.94, 0.94));
        const std::vector<Vec3d> points =
            random_points(near, most_bent, options_.threads, part_of(progress_, 0.94, 0.94));
        const auto bend = bend_near(pipe, points);
        if (!bend || bend->least_start > 0) continue;
        place_on_bend_ = place_on(*bend, place, points);
        return doubt(fit, FitIssue::other_surface,
                     "the pipe bends at the place that was picked, or next to it, with a radius of " +
                         brief(bend->radius) + ": pick a place farther along the pipe, or fit a torus");
    }
}

// The rim of a flange is a band of a cylinder, and as well one of a sphere, which takes in a few points next to it.
void FollowedVerdict::doubt_equal_kind(const std::vector<Vec3d>& fitted, ShapeFit& fit) const
{
    const FollowingTuning& tuned = place_tuning().following;
    const bool may_be_band = fit.shape.kind == ShapeKind::sphere || fit.inliers < tuned.min_small_points;
    if (model_of(fit.shape.kind).rank != 1 || !may_be_band || !(fit.noise > 0)) return;
    const FitPoints points = FitPoints::of(fitted);
    const KindComparison compared(points, fit.noise);
    ShapeFitOptions options = options_.fit;
    options.threshold = fit.threshold;
    options.progress = part_of(progress_, 0.94, 0.94);
    for (const ShapeKind kind : options_.kinds) {
        if (kind == fit.shape.kind || model_of(kind).rank != 1) continue;
        options.kind = kind;
        const ShapeFit other = fit_shape(points, options);
        if (!other.has_shape()) continue;
        const std::vector<Vec3d> of_both = points_of_both(fitted, fit, other);
        const FitPoints both = FitPoints::of(of_both);
        const KindComparison on_both(both, fit.noise);
        const double evidence =
            std::min(compared.misfit(other.shape) - compared.misfit(fit.shape),
                     of_both.empty() ? infinity : on_both.misfit(other.shape) - on_both.misfit(fit.shape));
        if (evidence < place_tuning().kinds.min_evidence)
            doubt(fit, FitIssue::thin_arc,
                  std::string("a ") + traits_of(kind).name + " fits these points as well as a " +
                      traits_of(fit.shape.kind).name + ": take points farther around it, or fit the kind that it is");
    }
}

void FollowedVerdict::doubt_unsettled(const FollowedPoints& followed, FittedPrimitive& result) const
{
    const FollowingTuning& tuned = place_tuning().following;
    ShapeFit& fit = result.primitive.fit;
    const bool is_shared = !followed.part && followed.agreement > tuned.max_other_agreement;
    if (fit.verdict != FitVerdict::good || result.converged || !is_shared ||
        !(fit.noise > tuned.max_unsettled_noise * fit.threshold))
        return;
    doubt(fit, FitIssue::no_consensus,
          "it still changes after " + std::to_string(result.rounds) +
              " rounds, and neighbouring points leave it together: it may be a piece of another surface, so give a "
              "threshold, or take a smaller neighbourhood");
}

// The noise of close points does not include errors that neighbours share, nor shifts of stations that did not see the
// place. Such errors show as a bend, at the place or in all points.
bool FollowedVerdict::is_far_above_close_noise(const ShapeFit& fit, double noise, double bend, const NearPoints& near)
{
    const FollowingTuning& tuned = place_tuning().following;
    if (!(known_noise() > 0) || !(noise > std::hypot(tuned.max_close_noise * known_noise(), stations().spread)))
        return false;
    const SurfaceEvidence at_place = surface_evidence(fit.shape, spread_of(fit), resolution(), near.points.sources());
    return std::max(bend, at_place.bend) < tuned.min_shared_bend;
}

// A fit that was narrowed or followed may leave the place, which is then one of another surface next to it.
bool FollowedVerdict::passes_places(const ShapeFit& fit, const NearPoints& near) const
{
    return std::all_of(places_.begin(), places_.end(), [&](const Vec3d& place) {
        double to_cloud = infinity;
        for (std::size_t i = 0; i < near.ids.size(); ++i)
            to_cloud = std::min(to_cloud, length(near.points.source(i) - place));
        return distance_to(fit.shape, place) <= to_cloud + farthest_place(fit);
    });
}

double FollowedVerdict::resolution() const { return largest_magnitude(cloud_.info().grid.scale); }

double FollowedVerdict::known_noise() const
{
    if (known_.close_noise > 0 && known_.own_noise > 0) return std::min(known_.close_noise, known_.own_noise);
    return std::max(known_.close_noise, known_.own_noise);
}

// Stations that the registration has left apart make a round pipe out of round by as much.
const FollowedVerdict::Stations& FollowedVerdict::stations()
{
    if (stations_) return *stations_;
    stations_ = {known_.registration, known_.registration};
    if (!around_.are_named()) return *stations_;
    const StationSpread found = around_.spread_with({});
    const double most = found.spread > 0 ? found.spread * student_factor(found.freedom) : 0;
    stations_ = {std::max(found.spread, known_.registration), std::max(most, known_.registration)};
    return *stations_;
}

// What is left of it beyond shifts of stations; nothing where it is not known which points are a station's.
Departure FollowedVerdict::without_stations(const Departure& departure, const std::optional<SweptPart>& part,
                                            const FittedPrimitive& result)
{
    const double spread = stations().spread;
    if (departure.is_smooth(known_noise()) && departure.size > place_tuning().departure.min_station_spreads * spread)
        return departure;
    const double most = stations().most_spread;
    if (!(known_noise() > 0 && around_.are_named())) return {};
    if (!(most > 0)) return departure;
    return departure_within_stations(result.points, result.primitive.fit, around_.points(), {most, known_noise()}, part,
                                     options_.threads, part_of(progress_, 0.94, 0.94));
}

// Two stations apart leave a surface to both of its sides, by what other surfaces show of them and no more; and their
// shifts explain as much of the noise as lies between two peaks.
bool FollowedVerdict::is_of_stations(double noise, const SurfaceEvidence& evidence,
                                     const std::optional<SweptPart>& part, const FittedPrimitive& result)
{
    if (!evidence.has_two_peaks()) return false;
    const double spread = stations().spread;
    if (!(spread > 0 && noise <= place_tuning().following.max_station_noise * std::hypot(known_noise(), spread)))
        return false;
    if (!around_.are_named()) return true;
    const Departure own = departure_within_stations(result.points, result.primitive.fit, around_.points(),
                                                    {stations().most_spread, known_noise()}, part, options_.threads,
                                                    part_of(progress_, 0.94, 0.94));
    const double left = place_tuning().following.max_left_by_stations * (1 - share_between(evidence.two_peaks));
    return own.points == 0 || own.rest * own.rest <= left * noise * noise;
}

// Where the noise is larger than that around the places, and no threshold allows for it.
std::optional<ShapeKind> FollowedVerdict::far_better_kind(const FittedPrimitive& result, double noise,
                                                          const std::vector<Vec3d>& around) const
{
    if (options_.fit.threshold > 0) return {};
    if (!(known_.close_noise > 0 && noise > place_tuning().following.max_noise_growth * known_.close_noise)) return {};
    ShapeFit fit = result.primitive.fit;
    fit.noise = noise;
    const auto other =
        better_kind(fit, result.near.points.sources(), known_.close_noise, part_of(progress_, 0.94, 0.97));
    return other ? other : better_kind(fit, around, known_.close_noise, part_of(progress_, 0.97, 1));
}

// Compares kinds by the points on the shape and around it: there a pipe leaves a plane that touches it. The rank is at
// most the next one: where a plane is a cone in truth, a cylinder is more probable, too, and is judged in its turn.
void FollowedVerdict::find_other_kind(const ShapeFit& fit, const PointSet& around)
{
    const FitPoints compared =
        FitPoints::of(random_points(around, most_compared, options_.threads, part_of(progress_, 0.94, 0.94)));
    std::vector<ShapeFit> fits{fit};
    ShapeFitOptions options = options_.fit;
    options.threshold = fit.threshold;
    options.progress = part_of(progress_, 0.94, 0.94);
    const FollowingTuning& tuned = place_tuning().following;
    double own = 0;
    for (std::size_t i = 0; i < compared.size(); ++i)
        own += distance_to(fit.shape, compared.source(i)) <= fit.threshold;
    for (const ShapeKind kind : options_.kinds) {
        if (kind == fit.shape.kind || model_of(kind).rank > model_of(fit.shape.kind).rank + 1) continue;
        options.kind = kind;
        fits.push_back(fit_shape(compared, options));
        const ShapeFit& other = fits.back();
        const bool is_as_near = other.noise <= tuned.max_other_noise * fit.noise &&
                                static_cast<double>(other.inliers) >= tuned.min_other_share * own;
        if (other.verdict != FitVerdict::good || !is_as_near) fits.pop_back();
    }
    fits.front().inliers = static_cast<std::uint64_t>(own);
    const KindChoice choice = choose_kind(fits, compared);
    if (choice.best && *choice.best > 0) other_ = std::move(fits[*choice.best]);
}

}  // namespace pcm
