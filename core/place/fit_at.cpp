#include "pcm/place/fit_at.h"

#include "pcm/cloud/condition.h"
#include "pcm/cloud/numbers.h"
#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/tuning.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/place/best_kind.h"
#include "pcm/place/cover_points.h"
#include "pcm/place/few_points.h"
#include "pcm/place/fit_again.h"
#include "pcm/place/fit_at_arguments.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/inner_points.h"
#include "pcm/place/local_fit.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/other_answers.h"
#include "pcm/place/point_off.h"
#include "pcm/place/station_errors.h"
#include "pcm/place/stations_around.h"
#include "pcm/place/tuning.h"
#include "pcm/place/turned_surface.h"
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

constexpr double not_compared = 4;              // angle of surfaces, radians
const double even_spread = 1 / std::sqrt(3.0);  // rms distance of points anywhere within a threshold, per threshold

class PlacedFit {
public:
    PlacedFit(const PointCloud& cloud, const std::vector<Vec3d>& places, const FitAtOptions& options)
        : cloud_(cloud),
          tree_(cloud.tree()),
          places_(places),
          options_(options),
          limit_(options.limit),
          around_(*tree_, places.front())
    {
    }

    FittedPrimitive run(const std::vector<Vec3d>& not_places)
    {
        for (const Vec3d& p : not_places) limit_.clips.push_back(left_out(cloud_, p, places_, limit_, options_));
        FittedPrimitive result = best_in_time();
        if (options_.grow && options_.fit.threshold == 0)
            doubt_small(result, metres_per_unit(tree_->info().metadata), options_.threads);
        compare_stations(result);
        find_bounds(result, part_of(options_.progress, 0.95, 1));
        result.primitive.fit.seconds = seconds_since(start_);
        return result;
    }

private:
    double registration() const  // source units
    {
        return options_.registration / 1000 / metres_per_unit(tree_->info().metadata);
    }

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
        options.registration = registration();
        options.metres_per_unit = metres_per_unit(tree_->info().metadata);
        options.threads = options_.threads;
        options.progress = part_of(options_.progress, 0.9, 0.95);
        add_station_errors(own_points(result, options_.threads, part_of(options_.progress, 0.9, 0.9)), around_, options,
                           result.agreement, result.primitive);
        if (result.agreement > 1)
            result.notes.push_back("neighbouring points leave the surface together: the errors are " +
                                   brief(result.agreement) + " times those of independent points");
    }

    // Whether the noise of a neighbourhood is that of its nearest points (even), it is the narrower neighbourhood for
    // which that holds (narrow), or there is such a narrower one (uneven). Then the noise of the surface, if it is one,
    // differs from place to place, and growth may raise the threshold.
    enum class Way { even, narrow, uneven };

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
            FittedPrimitive best = or_again(or_other(or_side(best_of_thresholds())));
            if (places_.size() == 1 && !is_again_ && !(options_.fit.threshold > 0))
                doubt_point_off(cloud_, places_.front(), limit_, best);
            return best;
        } catch (const Error& error) {
            if (error.code() != ErrorCode::cancelled || !is_late_) throw;
        }
        FittedPrimitive result = std::move(*at_places_);
        result.left_surface = "the time limit of " + brief(options_.fit.seconds) + " s was over";
        if (ShapeFit& fit = result.primitive.fit; fit.verdict == FitVerdict::good)
            doubt(fit, FitIssue::no_consensus,
                  result.left_surface +
                      " before it was followed through the cloud: these are the points around the place alone");
        return result;
    }

    // Where it lies between the two faces of a plate, the one that the stations at the place see.
    FittedPrimitive or_side(FittedPrimitive found)
    {
        const bool is_known = !stations_at_place_.empty() && around_.points().source() == StationSource::attribute;
        if (found.primitive.fit.verdict == FitVerdict::good || !is_known) return found;
        std::string chosen = around_.points().attribute() + '=';
        for (const std::uint32_t station : std::exchange(stations_at_place_, {}))
            chosen += (chosen.back() == '=' ? "" : ",") + std::to_string(station);
        limit_.where.push_back(parse_condition(chosen));
        FittedPrimitive side = best_of_thresholds();
        limit_.where.pop_back();
        if (side.primitive.fit.verdict != FitVerdict::good) return found;
        side.notes.push_back("it is the face of a plate that some stations see: points with " + chosen);
        return side;
    }

    // At another place, or for other kinds, where this answer is not good.
    FittedPrimitive or_again(FittedPrimitive found)
    {
        if (found.primitive.fit.verdict == FitVerdict::good || is_again_) return found;
        const FitAgain again = [this](const Vec3d& place, const std::vector<ShapeKind>& kinds) {
            FitAtOptions options = options_;
            options.limit = limit_;
            options.kinds = kinds;
            if (!kinds.empty()) options.fit.kind = kinds.front();
            options.progress = part_of(progress_in_time_, 0.9, 1);
            options.found_at_place = {};
            const std::vector<Vec3d> places{place};
            PlacedFit fit(cloud_, places, options);
            fit.is_again_ = true;
            return fit.best_in_time();
        };
        const Vec3d place = places_.front();
        if (places_.size() == 1 && local_options().may_choose(found.primitive.fit.shape.kind)) {
            std::vector<ShapeKind> kinds = options_.kinds;
            if (place_on_bend_) kinds.erase(std::remove(kinds.begin(), kinds.end(), ShapeKind::cone), kinds.end());
            const double most = tuned_.max_shared_noise * around_.surface_noise();
            found = or_higher_kind(std::move(found), place, most, kinds, again, options_.threads);
        }
        if (!place_on_bend_) return found;
        return or_elbow(std::move(found), place, *place_on_bend_, options_.kinds, again);
    }

    FittedPrimitive or_other(FittedPrimitive found)
    {
        if (places_.size() != 1) return found;
        LocalFitOptions options = local_options();
        options.progress = part_of(progress_in_time_, 0.9, 0.9);
        const FollowShape follow = [this](LocalFit local, const std::optional<Clip>& side) {
            whole_progress_ = part_of(progress_in_time_, 0.9, 1);
            if (side) limit_.clips.push_back(*side);
            FittedPrimitive other = followed(std::move(local), Way::even, 0, 1);
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
        const Way way = narrow ? Way::uneven : Way::even;
        FittedPrimitive of_wide = followed(wide, way, 0.4, narrow ? 0.65 : 0.9);
        is_cut_early_ = cuts_noise_ && wide.is_first_threshold;
        if (other_kind_)
            follow_other_kind(std::move(wide), way, of_wide);
        else
            follow_next_kind(std::move(wide), way, of_wide);
        if (!narrow) return of_wide;
        const bool is_good = of_wide.primitive.fit.verdict == FitVerdict::good;
        if (is_good && holds_inliers(of_wide.primitive.fit.shape, *narrow)) return of_wide;
        FittedPrimitive of_narrow = followed(std::move(*narrow), Way::narrow, 0.65, 1);
        return is_good && of_narrow.primitive.fit.verdict != FitVerdict::good ? of_wide : of_narrow;
    }

    // Growth shows what neighbourhoods are too small for: that a plane is an arc, a cylinder a cone. Errors that
    // neighbours share with that kind, too, are those of the scanner: then the first one's verdict stands.
    void follow_other_kind(LocalFit local, Way way, FittedPrimitive& result)
    {
        const std::string other_doubt = other_doubt_;
        local.fit = *other_kind_;
        local.fit.inliers = 0;
        local.fit.is_inlier.assign(local.near.ids.size(), 0);
        for (std::size_t i = 0; i < local.near.ids.size(); ++i) {
            const bool is_on = distance_to(local.fit.shape, local.near.points.source(i)) <= local.fit.threshold;
            local.fit.is_inlier[i] = is_on ? 1 : 0;
            local.fit.inliers += is_on ? 1 : 0;
        }
        if (local.fit.inliers == 0) return doubt_kind(other_doubt, result.primitive.fit);
        local.next_kind = std::string("next best kind: ") + traits_of(result.primitive.fit.shape.kind).name +
                          ", noise " + brief(result.primitive.fit.noise);
        const double enough = std::max(tuned_.max_other_agreement, tuned_.less_agreement * agreement_);
        FittedPrimitive other = followed(std::move(local), way, 0.9, 1);
        if (other.primitive.fit.verdict != FitVerdict::good)
            doubt_kind(other_doubt, result.primitive.fit);
        else if (agreement_ <= enough)
            result = std::move(other);
    }

    // The best kind of a neighbourhood that is hardly more than a piece of the shape cannot be followed: the end of an
    // elbow is a cylinder, as far as it goes. Then one that has more numbers may be.
    void follow_next_kind(LocalFit local, Way way, FittedPrimitive& result)
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
        FittedPrimitive next = followed(std::move(local), way, 0.9, 1);
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
        at_places_ = at_places(local);
        at_places_->reached.turned_angle = angle_of(Way::even);
        if (!options_.found_at_place || !local.fit.has_shape()) return;
        FittedPrimitive found = *at_places_;
        find_bounds(found, {});
        options_.found_at_place(found.primitive);
    }

    // The shape of a neighbourhood and its points there.
    FittedPrimitive at_places(LocalFit local) const
    {
        FittedPrimitive result{{}, PointSet(tree_), {}, {}, {}, 0, 0, false, 1, {}, {}, {}, {}};
        result.near = std::move(local.near);
        result.local = std::move(local.fit);
        result.notes = std::move(local.notes);
        Primitive& primitive = result.primitive;
        primitive.cloud = tree_->folder().string();
        primitive.estimator = traits_of(options_.fit.estimator).name;
        primitive.fit = result.local;
        primitive.fit.is_inlier.clear();
        if (!local.next_kind.empty()) result.notes.push_back(local.next_kind);
        if (!result.local.has_shape()) return result;
        std::map<NodeId, std::vector<std::uint32_t>> inliers;
        for (std::size_t i = 0; i < result.near.ids.size(); ++i)
            if (result.local.is_inlier[i]) {
                inliers[result.near.ids[i].node].push_back(result.near.ids[i].index);
                result.reached.seeds.push_back(result.near.points.source(i));
            }
        for (auto& [node, numbers] : inliers) {
            std::sort(numbers.begin(), numbers.end());
            result.points.set(node, numbers);
        }
        result.reached.shape = result.local.shape;
        result.reached.threshold = result.local.threshold;
        result.reached.normal_angle = options_.fit.normal_angle;
        result.reached.limit = limit_;
        return result;
    }

    FittedPrimitive followed(LocalFit local, Way way, double begin, double end)
    {
        known_ = {local.noise / fit_tuning().thresholds.inlier_noises, local.even.noise, registration()};
        other_kind_.reset();
        cuts_noise_ = false;
        progress_ = part_of(whole_progress_, begin, end);
        const NearPoints close = std::move(local.close);
        FittedPrimitive result = at_places(std::move(local));
        result.reached.turned_angle = angle_of(way);
        if (options_.grow && !result.points.empty()) follow(close, way, result);
        return result;
    }

    void follow(const NearPoints& close, Way way, FittedPrimitive& result)
    {
        const ShapeFit& local = result.local;
        std::vector<Vec3d> positions;
        for (std::size_t i = 0; i < close.ids.size(); ++i)
            if (const Vec3d p = close.points.source(i); distance_to(local.shape, p) <= local.threshold)
                positions.push_back(p);
        result.step = options_.step > 0 ? options_.step : step_for(local.shape, automatic_step(positions));
        if (options_.step <= 0 && positions.size() < 2 && close.ids.size() >= 2)
            return come_back("none of the nearest points of the place lie on it", FitIssue::no_consensus, result);
        if (!(result.step > 0) || !(local.threshold > 0)) return;
        GrowShapeOptions options;
        options.threshold = local.threshold;
        options.raise_threshold = way == Way::uneven;
        options.lower_threshold = options_.fit.threshold == 0;
        const double noise = options_.fit.threshold > 0 ? std::min(local.noise, local.threshold)
                                                        : local.threshold / fit_tuning().thresholds.inlier_noises;
        options.turned_edge = result.reached.turned_edge = TurnedSurface::edge_for(result.step, noise);
        if (!(options_.turned_angle > 0) &&
            !TurnedSurface::is_shown_on(local.shape, local.threshold, options.turned_edge))
            result.reached.turned_angle = not_compared;
        options.turned_angle = result.reached.turned_angle;
        options.step = result.step;
        options.normal_angle = options_.fit.normal_angle;
        options.most_rounds = options_.rounds;
        options.limit = limit_;
        options.memory_bytes = options_.memory_bytes;
        options.threads = options_.threads;
        options.progress = part_of(progress_, 0, way == Way::even ? 0.6 : 0.9);
        FittedPrimitive raised = result;
        take(grow_shape(local.shape, result.points, options), way == Way::narrow, result);
        if (!cuts_noise_ || way != Way::even || result.primitive.fit.verdict == FitVerdict::good) return;
        // The surface's noise is larger elsewhere than at the place.
        options.raise_threshold = true;
        options.progress = part_of(progress_, 0.6, 0.9);
        take(grow_shape(local.shape, raised.points, options), false, raised);
        if (raised.left_surface.empty()) result = std::move(raised);
    }

    // Errors that neighbours share turn a surface: where the noise is uneven, it may be turned farther.
    double angle_of(Way way) const
    {
        if (options_.turned_angle > 0) return options_.turned_angle;
        if (options_.fit.threshold > 0) return not_compared;
        return way == Way::uneven ? pi / 4 : pi / 6;
    }

    // Where the place was picked, points may lie closer than elsewhere; and what stands before a pipe or a tank hides
    // less than half of its width.
    static double step_for(const Shape& shape, double step)
    {
        return std::max(step, std::min(4 * step, narrowest_radius(shape) / 2));
    }

    void take(GrownShape grown, bool is_narrow, FittedPrimitive& result)
    {
        cuts_noise_ = false;
        result.rounds = grown.rounds;
        result.converged = grown.converged;
        if (!grown.fit.has_shape())
            return come_back("the points reached determine no shape (" + std::string(name_of(grown.fit.issue)) + ")",
                             grown.fit.issue, result);
        if (options_.fit.threshold == 0 && grown.fit.noise > tuned_.max_noise_growth * result.local.noise)
            return come_back("its points leave it by " + brief(grown.fit.noise) + ", those around the place by " +
                                 brief(result.local.noise),
                             FitIssue::no_consensus, result);
        if (options_.fit.threshold == 0 && grown.fit.noise > even_spread * grown.threshold) {
            cuts_noise_ = true;
            return come_back("its points are spread evenly within the threshold, as points of no surface are",
                             FitIssue::no_consensus, result);
        }
        FittedPrimitive followed{result};
        take_grown(std::move(grown), followed);
        if (is_narrow) {
            if (other_kind_) doubt_kind(other_doubt_, followed.primitive.fit);
            doubt_few_points(followed);
        }
        const ShapeFit& fit = followed.primitive.fit;
        const bool is_doubted = fit.verdict != FitVerdict::good && result.local.verdict == FitVerdict::good;
        if (options_.fit.threshold == 0 && is_doubted && (is_narrow || fit.issue == FitIssue::no_consensus))
            return come_back(fit.message, fit.issue, result);
        result = std::move(followed);
    }

    void take_grown(GrownShape grown, FittedPrimitive& result)
    {
        result.agreement = grown.agreement;
        result.part = grown.part;
        result.points = std::move(grown.points);
        result.reached.shape = grown.followed;
        result.reached.threshold = grown.threshold;
        result.reached.step = result.step;
        keep_reached_seeds(result);
        grown.fit.iterations = result.local.iterations;
        if (result.local.issue == FitIssue::no_consensus || result.local.issue == FitIssue::other_surface) {
            grown.fit.verdict = result.local.verdict;
            grown.fit.issue = result.local.issue;
            grown.fit.message = result.local.message;
        }
        result.primitive.fit = std::move(grown.fit);
        FollowedVerdict verdict(cloud_, places_, options_, known_, around_, progress_);
        agreement_ = grown.agreement;
        verdict.judge({grown.around, grown.noise, grown.agreement, grown.part, grown.inner_share}, result);
        other_kind_ = verdict.other_kind();
        other_doubt_ = verdict.other_doubt();
        cuts_noise_ = verdict.cuts_noise();
        place_on_bend_ = verdict.place_on_bend();
        stations_at_place_ = verdict.stations_at_place();
    }

    static void keep_reached_seeds(FittedPrimitive& result)
    {
        std::vector<Vec3d> reached;
        for (std::size_t i = 0; i < result.near.ids.size(); ++i)
            if (result.local.is_inlier[i] && result.points.contains(result.near.ids[i].node, result.near.ids[i].index))
                reached.push_back(result.near.points.source(i));
        result.reached.seeds = std::move(reached);
        keep_few_seeds(result.reached, true);
    }

    const PointCloud& cloud_;
    const std::shared_ptr<const Tree> tree_;
    const std::vector<Vec3d>& places_;
    const FitAtOptions& options_;
    const FollowingTuning& tuned_ = place_tuning().following;
    Selection limit_;
    StationsAround around_;
    ProgressFunction whole_progress_, progress_;      // progress at one threshold; of following a shape there
    bool cuts_noise_ = false, is_cut_early_ = false;  // whether a threshold cut the noise of the points reached
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    bool is_late_ = false;
    std::optional<FittedPrimitive> at_places_;  // the shape before it is followed
    bool is_kept_ = false;                      // whether that is the one of the widest neighbourhood
    ProgressFunction progress_in_time_;         // ends what follows the shape when the time is over
    KnownErrors known_;
    std::optional<ShapeFit> other_kind_;  // FollowedVerdict::other_kind()
    std::string other_doubt_;
    double agreement_ = 1;                          // GrownShape::agreement of the last one
    std::optional<Vec3d> place_on_bend_;            // FollowedVerdict::place_on_bend() of the last one
    std::vector<std::uint32_t> stations_at_place_;  // FollowedVerdict::stations_at_place() of the last one
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
