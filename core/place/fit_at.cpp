#include "pcm/place/fit_at.h"

#include "pcm/cloud/condition.h"
#include "pcm/cloud/numbers.h"
#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/tuning.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/place/best_kind.h"
#include "pcm/place/cover_points.h"
#include "pcm/place/depth_levels.h"
#include "pcm/place/few_points.h"
#include "pcm/place/fit_again.h"
#include "pcm/place/fit_at_arguments.h"
#include "pcm/place/follow_local.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/nearest_answer.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/other_answers.h"
#include "pcm/place/own_points.h"
#include "pcm/place/point_off.h"
#include "pcm/place/refit.h"
#include "pcm/place/station_errors.h"
#include "pcm/place/stations_around.h"
#include "pcm/place/tuning.h"
#include "pcm/system/error.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/seconds.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace pcm {
namespace {

class PlacedFit {
public:
    PlacedFit(const PointCloud& cloud, const std::vector<Vec3d>& places, const FitAtOptions& options)
        : cloud_(cloud),
          tree_(cloud.tree()),
          places_(places),
          options_(options),
          limit_(options.limit),
          around_(*tree_, places.front()),
          follower_(cloud, places, options, limit_, around_)
    {
    }

    FittedPrimitive run(const std::vector<Vec3d>& not_places)
    {
        for (const Vec3d& p : not_places) limit_.clips.push_back(left_out(cloud_, p, places_, limit_, options_));
        FittedPrimitive result = best_in_time();
        if (options_.grow && options_.fit.threshold == 0)
            doubt_small(result, metres_per_unit(tree_->info().metadata), options_.threads);
        compare_stations(result);
        // Errors that neighbours share, of edges and of rays are added after the fit was judged.
        if (ShapeFit& fit = result.primitive.fit; !is_size_certain(fit))
            doubt(fit, FitIssue::thin_arc,
                  "the points cover too little of the shape for the errors that they share, so its size is uncertain: "
                  "take points farther around it");
        if (places_.size() == 1 && !(options_.fit.threshold > 0))
            doubt_point_aside(cloud_, places_.front(), limit_, result);
        find_bounds(result, part_of(options_.progress, 0.95, 1));
        doubt_level(cloud_, options_.limit, result.primitive);
        result.primitive.fit.seconds = seconds_since(start_);
        return result;
    }

private:
    void find_bounds(FittedPrimitive& result, const ProgressFunction& progress) const
    {
        Primitive& primitive = result.primitive;
        primitive.points = result.points.size();
        if (result.points.empty()) return;
        // A concave outline takes a triangulation of the points, and has as many corners as they need.
        const std::size_t most = options_.outline.kind == OutlineKind::concave ? 100000 : 1000000;
        primitive.bounds = bounds_of(primitive.fit.shape,
                                     cover_points(result.points, primitive.fit.shape, options_.threads, progress, most),
                                     options_.outline, tree_->info().bounds());
    }

    void compare_stations(FittedPrimitive& result)
    {
        StationErrorOptions options;
        options.registration = registration_of(options_, *tree_);
        options.metres_per_unit = metres_per_unit(tree_->info().metadata);
        options.threads = options_.threads;
        options.doubt_noise = !(options_.fit.threshold > 0);
        options.progress = part_of(options_.progress, 0.9, 0.95);
        add_station_errors(own_points(result, options_.threads, part_of(options_.progress, 0.9, 0.9)), around_, options,
                           result.agreement, result.primitive);
        if (result.agreement > 1)
            result.notes.push_back("neighbouring points leave the surface together: the errors are " +
                                   brief(result.agreement) + " times those of independent points");
    }

    // When the time is over, the shape of the places.
    FittedPrimitive best_in_time()
    {
        const ProgressFunction whole = [this](const ProgressUpdate& update) {
            is_late_ = is_late_ || (at_places_ && seconds_since(start_) > options_.fit.seconds);
            return !is_late_ && (!options_.progress || options_.progress(update));
        };
        const bool is_limited = options_.grow && options_.fit.seconds > 0;
        progress_in_time_ = is_limited ? whole : options_.progress;
        try {
            FittedPrimitive best = or_small(or_part(or_again(or_other(or_side(best_of_thresholds())))));
            if (places_.size() == 1 && !is_again_ && !(options_.fit.threshold > 0))
                doubt_point_off(cloud_, places_.front(), limit_, best);
            return best;
        } catch (const Error& error) {
            if (error.code() != ErrorCode::cancelled || !is_late_) throw;
        }
        FittedPrimitive result = std::move(*at_places_);
        result.left_surface = "the time limit of " + brief(options_.fit.seconds) + " s was over";
        doubt(result.primitive.fit, FitIssue::no_consensus,
              result.left_surface +
                  " before it was followed through the cloud: these are the points around the place alone");
        return result;
    }

    // Where it lies between the two faces of a plate, the one that the stations at the place see.
    FittedPrimitive or_side(FittedPrimitive found)
    {
        const bool is_known =
            !facts_.stations_at_place.empty() && around_.points().source() == StationSource::attribute;
        if (found.primitive.fit.verdict == FitVerdict::good || !is_known) return found;
        std::string chosen = around_.points().attribute() + '=';
        for (const std::uint32_t station : std::exchange(facts_.stations_at_place, {}))
            chosen += (chosen.back() == '=' ? "" : ",") + std::to_string(station);
        limit_.where.push_back(parse_condition(chosen));
        FittedPrimitive side = best_of_thresholds();
        limit_.where.pop_back();
        if (side.primitive.fit.verdict != FitVerdict::good) return found;
        side.notes.push_back("it is the face of a plate that some stations see: points with " + chosen);
        return side;
    }

    FitAgain fit_again()
    {
        return [this](const Vec3d& place, const std::vector<ShapeKind>& kinds, const std::optional<Clip>& part) {
            FitAtOptions options = options_;
            options.limit = limit_;
            if (part) options.limit.clips.push_back(*part);
            options.kinds = kinds;
            if (!kinds.empty()) options.fit.kind = kinds.front();
            return answer_again(place, std::move(options));
        };
    }

    FittedPrimitive answer_again(const Vec3d& place, FitAtOptions options) const
    {
        options.progress = part_of(progress_in_time_, 0.9, 1);
        options.found_at_place = {};
        const std::vector<Vec3d> places{place};
        PlacedFit fit(cloud_, places, options);
        fit.is_again_ = true;
        return fit.best_in_time();
    }

    // Errors of a cylinder that neighbours share may be those of a reducer.
    FittedPrimitive or_part(FittedPrimitive found)
    {
        if (is_again_ || !options_.grow || options_.fit.threshold > 0 || places_.size() != 1) return found;
        if (!(found.agreement > place_tuning().radius_steps.min_agreement)) return found;
        const double spread = around_.spread(registration_of(options_, *tree_));
        return or_one_radius(std::move(found), places_.front(), spread, fit_again(), options_.threads);
    }

    // The shape of the points next to the place alone, where this answer is not good.
    FittedPrimitive or_small(FittedPrimitive found)
    {
        if (is_again_ || !options_.grow || local_options().is_given() || places_.size() != 1) return found;
        if (found.primitive.fit.verdict == FitVerdict::good) return found;
        NearOptions nearest;
        nearest.places = true;
        nearest.count = place_tuning().near_place.points;
        nearest.limit = limit_;
        const NearPoints near = points_near(cloud_, places_.front(), nearest);
        double noise = around_.survey().noise();
        if (!(noise > 0)) noise = automatic_threshold(near.points) / fit_tuning().thresholds.inlier_noises;
        const FitOfNearest fit = [&](std::size_t count, bool grow) {
            FitAtOptions options = options_;
            options.limit = limit_;
            options.count = count;
            options.grow = grow;
            return answer_again(places_.front(), std::move(options));
        };
        found = or_nearest(std::move(found), places_.front(), near, noise, fit);
        // Levels of a depth camera and strips of terrain are planes of a few dozen points, too.
        if (!around_.are_named())
            doubt(found.primitive.fit, FitIssue::no_consensus,
                  "it was found by the points next to the place alone, and no other station confirms it: compare it "
                  "with a section, or pick more places");
        if (ShapeFit& fitted = found.primitive.fit; fitted.noise < place_tuning().near_place.min_noise * noise)
            doubt(fitted, FitIssue::no_consensus,
                  "its points have a noise of " + brief(fitted.noise) + ", those of surfaces around of " +
                      brief(noise) + ": they may be one level of a depth camera, so compare it with a section");
        // A neighbourhood of given size is not compared with the faces around it.
        if (found.primitive.fit.verdict == FitVerdict::good) return or_part(or_other(std::move(found)));
        if (!local_options().may_choose(ShapeKind::cylinder)) return found;
        return or_band(std::move(found), places_.front(), near, noise, fit_again());
    }

    // At another place, or for other kinds, where this answer is not good.
    FittedPrimitive or_again(FittedPrimitive found)
    {
        if (found.primitive.fit.verdict == FitVerdict::good || is_again_) return found;
        const FitAgain again = fit_again();
        const Vec3d place = places_.front();
        if (places_.size() == 1 && local_options().may_choose(found.primitive.fit.shape.kind)) {
            std::vector<ShapeKind> kinds = options_.kinds;
            if (facts_.place_on_bend)
                kinds.erase(std::remove(kinds.begin(), kinds.end(), ShapeKind::cone), kinds.end());
            const double most = tuned_.max_shared_noise * around_.surface_noise();
            found = or_pipe(std::move(found), place, again);
            found = or_higher_kind(std::move(found), place, most, kinds, again, options_.threads);
        }
        if (!facts_.place_on_bend) return found;
        return or_elbow(std::move(found), place, *facts_.place_on_bend, options_.kinds, again);
    }

    FittedPrimitive or_other(FittedPrimitive found)
    {
        if (places_.size() != 1) return found;
        LocalFitOptions options = local_options();
        options.progress = part_of(progress_in_time_, 0.9, 0.9);
        const FollowShape follow = [this](LocalFit local, const std::optional<Clip>& side) {
            whole_progress_ = part_of(progress_in_time_, 0.9, 1);
            if (side) limit_.clips.push_back(*side);
            FittedPrimitive other = followed(std::move(local), NoiseNear::even, 0, 1).found;
            if (side) limit_.clips.pop_back();
            doubt_few_points(other);
            return other;
        };
        return OtherAnswers(cloud_, places_.front(), options, around_.survey().noise(), follow).best(std::move(found));
    }

    // The first threshold that holds all of the noise around the places may cut that of the rest of the surface:
    // ceilings that hang through, points far from the scanner. Then the shape is followed once more, with the threshold
    // at which it is least probable by chance. If that holds several surfaces, the noise of all points shows it.
    FittedPrimitive best_of_thresholds()
    {
        whole_progress_ = part_of(progress_in_time_, 0, 0.6);
        FittedPrimitive first = best_of_neighbourhoods(true);
        if (first.primitive.fit.verdict == FitVerdict::good || !is_cut_early_) return first;
        whole_progress_ = part_of(progress_in_time_, 0.6, 0.9);
        FittedPrimitive wider = best_of_neighbourhoods(false);
        const bool is_better = wider.primitive.fit.verdict == FitVerdict::good || wider.left_surface.empty();
        return is_better ? wider : first;
    }

    // Other surfaces may cause the noise of a wide neighbourhood: next to roofs of a hundred points, for example. So
    // where it is larger than the noise of the nearest points, the shape of a narrow neighbourhood is followed, too,
    // unless the wide one's shape is good and holds the narrow one's points. The narrow one's shape is the answer,
    // except where it is not good and the wide one's is: where neighbours share errors, it is only a part of the
    // surface and cannot be followed. Where neither is good, the narrow one's shape has the points of one surface at
    // least.
    FittedPrimitive best_of_neighbourhoods(bool first_threshold)
    {
        LocalFitOptions options = local_options();
        options.first_threshold = first_threshold;
        options.progress = part_of(whole_progress_, 0, 0.3);
        const bool is_needed = options_.grow && (options_.found_at_place || options_.fit.seconds > 0) && !is_kept_;
        if (is_needed) options.found_first = [this](const LocalFit& nearest) { keep(nearest); };
        LocalFit wide = fit_locally(cloud_, places_, options);
        options.found_first = {};
        if (is_needed && !(at_places_ && at_places_->near.found == wide.near.found)) keep(wide);
        is_kept_ = true;
        options.progress = part_of(whole_progress_, 0.3, 0.4);
        std::optional<LocalFit> narrow = fit_narrowly(cloud_, places_, options, wide);
        const NoiseNear way = narrow ? NoiseNear::uneven : NoiseNear::even;
        FollowedLocal first = followed(wide, way, 0.4, narrow ? 0.65 : 0.9);
        is_cut_early_ = first.cuts_noise && wide.is_first_threshold;
        if (first.other_kind)
            follow_other_kind(std::move(wide), way, first);
        else
            follow_next_kind(std::move(wide), way, first.found);
        FittedPrimitive of_wide = std::move(first.found);
        if (!narrow) return of_wide;
        const bool is_good = of_wide.primitive.fit.verdict == FitVerdict::good;
        if (is_good && holds_inliers(of_wide.primitive.fit.shape, *narrow)) return of_wide;
        FittedPrimitive of_narrow = followed(std::move(*narrow), NoiseNear::narrow, 0.65, 1).found;
        return is_good && of_narrow.primitive.fit.verdict != FitVerdict::good ? of_wide : of_narrow;
    }

    // Growth shows what neighbourhoods are too small for: that a plane is an arc, a cylinder a cone. Errors that
    // neighbours share with that kind, too, are those of the scanner: then the first one's verdict stands.
    void follow_other_kind(LocalFit local, NoiseNear way, FollowedLocal& first)
    {
        FittedPrimitive& result = first.found;
        local.fit = *first.other_kind;
        local.fit.inliers = 0;
        local.fit.is_inlier.assign(local.near.ids.size(), 0);
        for (std::size_t i = 0; i < local.near.ids.size(); ++i) {
            const bool is_on = distance_to(local.fit.shape, local.near.points.source(i)) <= local.fit.threshold;
            local.fit.is_inlier[i] = is_on ? 1 : 0;
            local.fit.inliers += is_on ? 1 : 0;
        }
        if (local.fit.inliers == 0) return doubt(result.primitive.fit, FitIssue::other_surface, first.other_doubt);
        local.next_kind = std::string("next best kind: ") + traits_of(result.primitive.fit.shape.kind).name +
                          ", noise " + brief(result.primitive.fit.noise);
        const double enough = std::max(tuned_.max_other_agreement, tuned_.less_agreement * facts_.agreement);
        FittedPrimitive other = followed(std::move(local), way, 0.9, 1).found;
        if (other.primitive.fit.verdict != FitVerdict::good)
            doubt(result.primitive.fit, FitIssue::other_surface, first.other_doubt);
        else if (facts_.agreement <= enough)
            result = std::move(other);
    }

    // The best kind of a neighbourhood that is hardly more than a piece of the shape cannot be followed: the end of an
    // elbow is a cylinder, as far as it goes. Then one that has more numbers may be.
    void follow_next_kind(LocalFit local, NoiseNear way, FittedPrimitive& result)
    {
        if (result.primitive.fit.verdict == FitVerdict::good || model_of(local.fit.shape.kind).rank == 0) return;
        const std::string first = std::string("next best kind: ") + traits_of(local.fit.shape.kind).name +
                                  ", which cannot be followed through the cloud";
        if (local.higher)
            local.fit = *std::exchange(local.higher, std::nullopt);
        else if (auto wider = fit_more_numbers(cloud_, places_, local_options(), local))
            local = std::move(*wider);
        else
            return;
        local.next_kind = first;
        FittedPrimitive next = followed(std::move(local), way, 0.9, 1).found;
        doubt_few_points(next);
        if (next.primitive.fit.verdict == FitVerdict::good &&
            explains_better(next.primitive.fit, result.primitive.fit.shape,
                            random_points(own_points(next, options_.threads, part_of(options_.progress, 0.9, 0.9)),
                                          enough_compared, options_.threads)))
            result = std::move(next);
    }

    LocalFitOptions local_options() const
    {
        LocalFitOptions options;
        options.fit = options_.fit;
        options.kinds = options_.kinds;
        options.radius = options_.radius;
        options.count = options_.count;
        options.limit = limit_;
        return options;
    }

    // What is answered when the time is over, and shown before the shape is followed.
    void keep(const LocalFit& local)
    {
        at_places_ = follower_.at_places(local);
        at_places_->reached.turned_angle = follower_.turned_angle(NoiseNear::even);
        if (!options_.found_at_place || !local.fit.has_shape()) return;
        FittedPrimitive found = *at_places_;
        find_bounds(found, {});
        options_.found_at_place(found.primitive);
    }

    FollowedLocal followed(LocalFit local, NoiseNear noise, double begin, double end)
    {
        FollowedLocal followed = follower_.follow(std::move(local), noise, part_of(whole_progress_, begin, end));
        if (followed.facts) facts_ = *followed.facts;
        return followed;
    }

    const PointCloud& cloud_;
    const std::shared_ptr<const Tree> tree_;
    const std::vector<Vec3d>& places_;
    const FitAtOptions& options_;
    const FollowingTuning& tuned_ = place_tuning().following;
    Selection limit_;
    StationsAround around_;
    const LocalFollower follower_;
    ProgressFunction whole_progress_;  // progress at one threshold
    bool is_cut_early_ = false;        // whether the first threshold cut the noise of the points reached
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    bool is_late_ = false;
    std::optional<FittedPrimitive> at_places_;  // the shape before it is followed
    bool is_kept_ = false;                      // whether that is the one of the widest neighbourhood
    ProgressFunction progress_in_time_;         // ends what follows the shape when the time is over
    FollowedFacts facts_;                       // those of the last shape that growth did not leave
    bool is_again_ = false;  // whether this is a fit that is made again, where another answer was not good
};

}  // namespace

FittedPrimitive fit_at(const PointCloud& cloud, const std::vector<Vec3d>& places, const std::vector<Vec3d>& not_places,
                       const FitAtOptions& options)
{
    require_arguments(places, not_places, options);
    return PlacedFit(cloud, places, options).run(not_places);
}

}  // namespace pcm
