#include "pcm/place/local_fit.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/pcl_fit.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/best_kind.h"
#include "pcm/place/even_noise.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/tuning.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t most_wider = 8000;  // points of a neighbourhood that is looked at for kinds of more numbers
constexpr std::size_t most_widenings = 3;
constexpr std::size_t most_points = 4000;  // maximum number of points in a fit of a chosen neighbourhood
constexpr int most_raised = 4;             // doublings of the threshold
constexpr int most_lowered = 3;            // halvings, where the noise of the closest points is that of two surfaces

class LocalSearch {
public:
    LocalSearch(const PointCloud& cloud, const std::vector<Vec3d>& places, const LocalFitOptions& options)
        : cloud_(cloud), places_(places), options_(options)
    {
    }

    LocalFit run()
    {
        LocalFit best;
        choose_kinds(best);
        gather_close(best);
        if (options_.radius > 0 || options_.count > 0) {
            best.near = neighbourhood(options_.radius, options_.count, 1000000, 0.1, 0.3);
            take(fitted(best.near, 0.3, 1), best);
            doubt_several_surfaces(best);
            return best;
        }
        best.near = best.close;
        take(fitted(best.near, 0.1, 0.2), best);
        if (options_.found_first && is_at_places(best)) options_.found_first(best);
        std::size_t count = is_at_places(best) ? tuned_.first_points : look_closer(best);
        for (std::size_t round = 1; round <= most_widenings && is_worth_widening(best); ++round) {
            count *= tuned_.widening;
            const double begin = 0.3 + 0.7 * static_cast<double>(round - 1) / most_widenings,
                         end = 0.3 + 0.7 * static_cast<double>(round) / most_widenings;
            NearPoints near = neighbourhood(0, count, most_points, begin, (begin + end) / 2);
            if (near.found <= best.near.found) break;  // these are all points
            BestKind kind = fitted(near, (begin + end) / 2, end);
            if (!is_improvement(kind.fit, near, best)) {
                if (best.fit.has_shape()) break;
                continue;
            }
            best.near = std::move(near);
            take(std::move(kind), best);
        }
        if (best.near.found < best.close.found)
            best.notes.push_back("the neighbourhood was narrowed to " + grouped(best.near.found) + " points");
        if (best.near.found > best.close.found)
            best.notes.push_back("the neighbourhood was widened to " + grouped(best.near.found) + " points");
        if (best.fit.has_shape() && !passes(best.fit, best.near)) {
            best.fit.verdict = FitVerdict::doubtful;
            best.fit.issue = FitIssue::no_consensus;
            best.fit.message = "it does not pass through the points nearest to the place: take a smaller neighbourhood";
        }
        doubt_several_surfaces(best);
        best.is_first_threshold = stopped_early_;
        return best;
    }

    std::optional<LocalFit> run_narrowly(const LocalFit& wide)
    {
        if (options_.is_given()) return {};
        const EvenNoise even = wide.even;
        const std::size_t among = even.count * places_.size();
        if (even.count == 0 || among >= wide.near.found || !(even.noise > 0)) return {};
        if (wide.fit.has_shape() &&
            !is_more_noise(wide.fit.noise * wide.fit.noise, static_cast<double>(wide.fit.inliers),
                           even.noise * even.noise, static_cast<double>(even.count)))
            return {};
        LocalFit narrow;
        choose_kinds(narrow);
        gather_close(narrow);
        noise_ = fit_tuning().thresholds.inlier_noises * even.noise;
        narrow.noise = noise_;
        narrow.near = narrow.close = neighbourhood(0, even.count, even.count, 0.2, 0.3);
        take(fitted(narrow.near, 0.3, 1), narrow);
        if (!is_at_places(narrow)) return {};
        narrow.notes.push_back("the neighbourhood was narrowed to " + grouped(narrow.near.found) +
                               " points: beyond these the noise rises");
        return narrow;
    }

private:
    // EvenNoise of the place with the narrowest neighbourhood.
    EvenNoise even_noise_at_places() const
    {
        EvenNoise even;
        for (const Vec3d& place : places_) {
            NearOptions options;
            options.places = true;
            options.count = tuned_.first_points;
            options.limit = options_.limit;
            const NearPoints near = points_near(cloud_, place, options);
            const EvenNoise here = even_noise(near.points.sources());
            if (even.count > 0 && here.count > even.count) continue;
            even = here;
        }
        return even;
    }

    NearPoints neighbourhood(double radius, std::size_t count, std::size_t most, double begin, double end)
    {
        NearPoints all;
        std::set<std::pair<NodeId, std::uint32_t>> known;
        for (std::size_t k = 0; k < places_.size(); ++k) {
            const double share = (end - begin) / static_cast<double>(places_.size());
            NearOptions options;
            options.places = true;
            options.radius = radius;
            options.count = count;
            options.most = most;
            options.limit = options_.limit;
            options.progress = part_of(options_.progress, begin + share * static_cast<double>(k),
                                       begin + share * static_cast<double>(k + 1));
            const NearPoints near = points_near(cloud_, places_[k], options);
            all.found += near.found;
            all.radius = std::max(all.radius, near.radius);
            all.spacing = std::max(all.spacing, near.spacing);
            if (all.ids.empty()) all.points.origin = near.points.origin;
            for (std::size_t i = 0; i < near.ids.size(); ++i) {
                if (!known.emplace(near.ids[i].node, near.ids[i].index).second) continue;
                all.ids.push_back(near.ids[i]);
                if (near.points.has_normals())
                    all.points.add(near.points.source(i), near.points.normal(i));
                else
                    all.points.add(near.points.source(i));
            }
        }
        return all;
    }

    // A single kind that the backend does not have is kept: the backend refuses it.
    void choose_kinds(LocalFit& result)
    {
        for (const ShapeKind kind : options_.kinds)
            if (options_.fit.backend == FitBackend::pcl && options_.kinds.size() > 1 && !pcl_has(kind))
                result.notes.push_back("the backend PCL has no " + std::string(traits_of(kind).name) +
                                       ": it is left out");
            else
                kinds_.push_back(kind);
        if (kinds_.empty()) kinds_.push_back(options_.fit.kind);
    }

    void gather_close(LocalFit& result)
    {
        result.close = neighbourhood(0, tuned_.first_points, tuned_.first_points, 0, 0.1);
        result.noise = automatic_threshold(result.close.points);
        noise_ = options_.fit.threshold > 0 ? options_.fit.threshold : result.noise;
        if (!(options_.fit.threshold > 0)) result.even = even_noise_at_places();
        for (const Vec3d& place : places_) {
            NearOptions options;
            options.places = true;
            options.count = tuned_.core_points;
            options.limit = options_.limit;
            const NearPoints core = points_near(cloud_, place, options);
            std::vector<Vec3d> positions = core.points.sources();
            if (positions.empty()) {
                result.notes.push_back("there is no point to fit a shape to; " + extent_text(cloud_.info().bounds()));
            } else {
                const double distance = length(positions.front() - place);
                if (distance > 10 * core.spacing)
                    result.notes.push_back("the place " + exact(place) + " lies " + brief(distance) +
                                           " source units from the nearest point");
            }
            cores_.push_back(std::move(positions));
        }
    }

    bool is_at_places(const LocalFit& found) const
    {
        return found.fit.has_shape() && passes(found.fit, found.near) && is_of_one_surface(found.fit, found.near);
    }

    // A given threshold states what lies on the surface.
    bool is_of_one_surface(const ShapeFit& fit, const NearPoints& near) const
    {
        if (options_.fit.threshold > 0 || !fit.has_shape() || !(fit.threshold > 0)) return true;
        return evidence_of(fit, near).is_one_surface();
    }

    SurfaceEvidence evidence_of(const ShapeFit& fit, const NearPoints& near) const
    {
        return surface_evidence(fit.shape, spread_of(fit), largest_magnitude(cloud_.info().grid.scale),
                                near.points.sources());
    }

    void doubt_several_surfaces(LocalFit& found) const
    {
        if (found.fit.verdict != FitVerdict::good || is_of_one_surface(found.fit, found.near)) return;
        doubt(found.fit, FitIssue::other_surface, evidence_of(found.fit, found.near).message());
    }

    // Where another surface has more points around the place; returns how many of the nearest points were taken.
    std::size_t look_closer(LocalFit& best)
    {
        NearPoints near = neighbourhood(0, tuned_.closer_points, tuned_.closer_points, 0.2, 0.22);
        BestKind kind = fitted(near, 0.22, 0.3);
        const ShapeFit& fit = kind.fit;
        if (near.found >= best.near.found || fit.verdict != FitVerdict::good || !passes(fit, near) ||
            !is_of_one_surface(fit, near))
            return tuned_.first_points;
        best.near = std::move(near);
        take(std::move(kind), best);
        return tuned_.closer_points;
    }

    static double share_of(const ShapeFit& fit, const NearPoints& near)
    {
        return static_cast<double>(fit.inliers) / static_cast<double>(std::max<std::size_t>(near.ids.size(), 1));
    }

    static bool is_worth_widening(const LocalFit& best)
    {
        if (best.fit.issue == FitIssue::not_finite) return false;
        return !is_determined(best.fit) || share_of(best.fit, best.near) > 1.0 / 3;
    }

    // Whether the shape passes through each place, and holds of the points around it at least half the share that it
    // holds of the neighbourhood.
    bool passes(const ShapeFit& fit, const NearPoints& near) const
    {
        for (std::size_t k = 0; k < places_.size(); ++k) {
            const std::vector<Vec3d>& core = cores_[k];
            if (core.empty()) continue;
            const double to_cloud = length(core.front() - places_[k]);
            if (distance_to(fit.shape, places_[k]) > to_cloud + farthest_place(fit)) return false;
            double on_it = 0;
            for (const Vec3d& p : core) on_it += distance_to(fit.shape, p) <= fit.threshold;
            if (on_it < 0.5 * share_of(fit, near) * static_cast<double>(core.size())) return false;
        }
        return true;
    }

    bool is_improvement(const ShapeFit& fit, const NearPoints& near, const LocalFit& best) const
    {
        if (!fit.has_shape() || !passes(fit, near)) return false;
        if (!best.fit.has_shape() || !passes(best.fit, best.near)) return true;
        const bool is_one = is_of_one_surface(fit, near);
        if (is_one != is_of_one_surface(best.fit, best.near)) return is_one;
        if (options_.fit.threshold == 0 && is_one && takes_in_surroundings(fit, near, best.fit)) return false;
        if (!follows(fit, best) ||
            !(chance_of(fit, near.points, near.radius) < chance_of(best.fit, near.points, near.radius)))
            return false;
        if (is_determined(fit) != is_determined(best.fit)) return is_determined(fit);
        const double before = share_of(best.fit, best.near) * static_cast<double>(best.near.found),
                     now = share_of(fit, near) * static_cast<double>(near.found);
        return now >= 1.5 * before;
    }

    // Whether the fit to a wider neighbourhood includes points next to the surface: it is of another kind with more
    // noise, or its threshold now cuts the noise, which neighbours do not share.
    bool takes_in_surroundings(const ShapeFit& fit, const NearPoints& near, const ShapeFit& before) const
    {
        if (!holds_noise(before)) return false;
        if (!holds_noise(fit) && !evidence_of(fit, near).has_shared_errors()) return true;
        if (fit.shape.kind == before.shape.kind) return false;
        const bool has_more = traits_of(fit.shape.kind).sizes.size() > traits_of(before.shape.kind).sizes.size();
        return fit.noise > (has_more ? tuned_.max_noise_wider : tuned_.max_noise_raised) * before.noise;
    }

    // Half of the former inliers are still near.
    static bool follows(const ShapeFit& fit, const LocalFit& best)
    {
        std::size_t near = 0;
        for (std::size_t i = 0; i < best.near.ids.size(); ++i)
            near +=
                best.fit.is_inlier[i] && distance_to(fit.shape, best.near.points.source(i)) <= 2 * best.fit.threshold;
        return 2 * near >= best.fit.inliers;
    }

    struct BestKind {
        ShapeFit fit;
        std::optional<ShapeFit> higher;  // LocalFit::higher
        std::string next_text;
    };

    static void take(BestKind kind, LocalFit& to)
    {
        to.fit = std::move(kind.fit);
        to.higher = std::move(kind.higher);
        to.next_kind = std::move(kind.next_text);
    }

    // The fit of the best kind. Kinds that hold several surfaces are used only where no kind holds one surface that
    // passes through the places.
    BestKind fitted(const NearPoints& near, double begin, double end) const
    {
        std::vector<ShapeFit> fits, of_one_surface;
        for (std::size_t k = 0; k < kinds_.size(); ++k) {
            const double share = (end - begin) / static_cast<double>(kinds_.size());
            ShapeFit fit = fitted(near, kinds_[k], begin + share * static_cast<double>(k),
                                  begin + share * static_cast<double>(k + 1));
            if (is_determined(fit) && passes(fit, near) && is_of_one_surface(fit, near)) of_one_surface.push_back(fit);
            fits.push_back(std::move(fit));
        }
        if (!of_one_surface.empty()) fits = std::move(of_one_surface);
        leave_out_noisier(near, fits);
        const KindChoice choice = choose_kind(fits, near.points);
        BestKind best;
        if (choice.next) best.next_text = text_of_next(fits[*choice.next], choice.log_ratio);
        best.fit = fits[choice.best.value_or(0)];
        best.higher = higher_kind(fits, best.fit);
        return best;
    }

    // The determined fit of least noise among kinds of higher rank than that of a curved one.
    static std::optional<ShapeFit> higher_kind(const std::vector<ShapeFit>& fits, const ShapeFit& best)
    {
        const int rank = model_of(best.shape.kind).rank;
        const ShapeFit* least = nullptr;
        for (const ShapeFit& fit : fits)
            if (is_determined(fit) && model_of(fit.shape.kind).rank > rank && (!least || fit.noise < least->noise))
                least = &fit;
        if (rank == 0 || !least) return {};  // a plane may be terrain
        return *least;
    }

    static std::string text_of_next(const ShapeFit& next, double log_ratio)
    {
        const ShapeTraits& traits = traits_of(next.shape.kind);
        std::string text = std::string("next best kind: ") + traits.name;
        if (traits.has_radius()) text += " of radius " + brief(next.shape.radius) + " ± " + brief(next.errors.radius);
        return text + ", noise " + brief(next.noise) + ", logarithm of the likelihood ratio " + brief(log_ratio);
    }

    // Thresholds differ from kind to kind: one that is wide enough for several surfaces holds more points.
    void leave_out_noisier(const NearPoints& near, std::vector<ShapeFit>& fits) const
    {
        if (options_.fit.threshold > 0) return;
        double least = infinity;
        for (const ShapeFit& fit : fits)
            if (is_determined(fit) && holds_noise(fit) && share_of(fit, near) >= tuned_.min_share && passes(fit, near))
                least = std::min(least, fit.noise);
        fits.erase(std::remove_if(fits.begin(), fits.end(),
                                  [&](const ShapeFit& fit) { return fit.noise > tuned_.max_noise_ratio * least; }),
                   fits.end());
    }

    bool holds_noise(const ShapeFit& fit) const { return fit.noise < tuned_.max_noise_share * fit.threshold; }

    // Whether a wider threshold adds nothing of the surface: the threshold holds all of its noise, and neighbours do
    // not share errors.
    bool is_sure(const ShapeFit& fit, const NearPoints& near) const
    {
        return is_sound(fit, near) && fit.noise < tuned_.max_sure_noise * fit.threshold &&
               evidence_of(fit, near).bend < tuned_.max_sure_bend;
    }

    bool is_enough(bool is_one, const ShapeFit& fit, const NearPoints& near) const
    {
        if (!options_.first_threshold || !is_one || !is_sure(fit, near)) return false;
        stopped_early_ = true;
        return true;
    }

    // A surface with the noise of its points, which passes the places.
    bool is_sound(const ShapeFit& fit, const NearPoints& near) const
    {
        return is_determined(fit) && holds_noise(fit) && share_of(fit, near) >= tuned_.min_share && passes(fit, near);
    }

    // Whether points of another surface are near the shape, with a threshold twice as large as before.
    bool takes_in_another(const ShapeFit& fit, const ShapeFit& before) const
    {
        return fit.has_shape() && before.has_shape() && fit.noise > tuned_.max_noise_raised * before.noise;
    }

    // The fit whose threshold is least probable by chance, among the thresholds that hold one surface if there are any.
    ShapeFit fitted(const NearPoints& near, ShapeKind kind, double begin, double end) const
    {
        ShapeFitOptions options = options_.fit;
        options.kind = kind;
        ShapeFit best, before;
        double least = 0;
        bool is_one = false;
        for (int raised = 0; raised <= most_raised; ++raised) {
            const double share = (end - begin) / (most_raised + 1);
            options.threshold = std::ldexp(noise_, raised);
            options.progress = part_of(options_.progress, begin + share * raised, begin + share * (raised + 1));
            if (raised > 0 && !(options.threshold < near.radius / 4)) break;
            ShapeFit fit = fit_shape(near.points, options);
            if (takes_in_another(fit, before)) break;
            if (fit.has_shape()) before = fit;
            const bool is_now = is_of_one_surface(fit, near);
            if (is_one && (!is_now || (holds_noise(best) && fit.noise > tuned_.max_noise_ratio * best.noise))) continue;
            const double chance = chance_of(fit, near.points, near.radius);
            const double gain = tuned_.min_gain * static_cast<double>(fit.inliers);
            const bool is_first = !best.has_shape() || (is_now && !is_one);
            if (raised == 0 || (fit.has_shape() && (is_first || chance + gain < least))) {
                best = std::move(fit);
                least = chance;
                is_one = best.has_shape() && is_now;
            }
            if (options_.fit.threshold > 0 || !(noise_ > 0) || is_enough(is_one, best, near)) break;
        }
        if (best.has_shape() && !is_one) lower(near, options, end, best);
        narrow(near, options, end, best);
        return best;
    }

    // Where the points closest to the place are those of two faces, so is their noise.
    void lower(const NearPoints& near, ShapeFitOptions options, double at, ShapeFit& best) const
    {
        options.progress = part_of(options_.progress, at, at);
        for (int lowered = 1; lowered <= most_lowered; ++lowered) {
            options.threshold = std::ldexp(noise_, -lowered);
            ShapeFit fit = fit_shape(near.points, options);
            if (!is_sound(fit, near) || !is_of_one_surface(fit, near)) continue;
            best = std::move(fit);
            return;
        }
    }

    // The surface has no points farther away than its noise. That of the closest points is less, unless they belong
    // to several surfaces.
    void narrow(const NearPoints& near, ShapeFitOptions options, double at, ShapeFit& best) const
    {
        double enough = fit_tuning().thresholds.inlier_noises * 1.1 * best.noise;
        if (noise_ <= tuned_.max_noise_ratio * enough) enough = std::max(noise_, enough);
        if (options_.fit.threshold > 0 || !best.has_shape() || !(enough < best.threshold)) return;
        options.threshold = enough;
        options.progress = part_of(options_.progress, at, at);
        ShapeFit fit = fit_shape(near.points, options);
        if (!fit.has_shape() || fit.verdict > best.verdict) return;
        if (is_of_one_surface(fit, near) || !is_of_one_surface(best, near)) best = std::move(fit);
    }

    const PointCloud& cloud_;
    const std::vector<Vec3d>& places_;
    const LocalFitOptions& options_;
    const NeighbourhoodTuning& tuned_ = place_tuning().neighbourhood;
    std::vector<ShapeKind> kinds_;           // candidates
    std::vector<std::vector<Vec3d>> cores_;  // the nearest points of each place
    double noise_ = 0;                       // threshold that holds the noise; 0: unknown
    mutable bool stopped_early_ = false;     // LocalFit::is_first_threshold
};

}  // namespace

bool holds_inliers(const Shape& shape, const LocalFit& local)
{
    double squares = 0;
    for (std::size_t i = 0; i < local.near.ids.size(); ++i)
        if (local.fit.is_inlier[i]) squares += std::pow(distance_to(shape, local.near.points.source(i)), 2);
    const double most = place_tuning().following.max_noise_growth * local.fit.noise;
    return squares <= most * most * static_cast<double>(local.fit.inliers);
}

LocalFit fit_locally(const PointCloud& cloud, const std::vector<Vec3d>& places, const LocalFitOptions& options)
{
    return LocalSearch(cloud, places, options).run();
}

std::optional<LocalFit> fit_more_numbers(const PointCloud& cloud, const std::vector<Vec3d>& places,
                                         LocalFitOptions options, const LocalFit& local)
{
    const bool is_given = options.is_given();
    options.count = place_tuning().neighbourhood.widening * local.near.found;
    std::vector<ShapeKind> kinds;
    for (const ShapeKind kind : options.kinds)
        if (model_of(kind).rank > model_of(local.fit.shape.kind).rank) kinds.push_back(kind);
    if (is_given || kinds.empty() || options.count > most_wider) return {};
    options.kinds = std::move(kinds);
    LocalFit wider = fit_locally(cloud, places, options);
    if (wider.fit.verdict != FitVerdict::good) return {};
    return wider;
}

std::optional<LocalFit> fit_narrowly(const PointCloud& cloud, const std::vector<Vec3d>& places,
                                     const LocalFitOptions& options, const LocalFit& wide)
{
    return LocalSearch(cloud, places, options).run_narrowly(wide);
}

}  // namespace pcm
