#include "pcm/place/fit_at.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/numbers.h"
#include "pcm/fit/tuning.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/place/best_kind.h"
#include "pcm/place/cover_points.h"
#include "pcm/place/local_fit.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/progress_part.h"
#include "pcm/place/station_errors.h"
#include "pcm/place/surface_beyond.h"
#include "pcm/place/tuning.h"
#include "pcm/place/turned_surface.h"
#include "pcm/system/error.h"
#include "pcm/system/seconds.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t most_judged = 20000;      // points, for whether they are a piece of another surface
const double even_spread = 1 / std::sqrt(3.0);  // of points anywhere within a threshold: rms distance, per threshold

void require(const std::vector<Vec3d>& places, const std::vector<Vec3d>& not_places, const FitAtOptions& options)
{
    const auto refuse = [](const std::string& what, const std::string& hint = {}) {
        throw Error(ErrorCode::invalid_argument, {}, what, hint);
    };
    if (places.empty()) refuse("no place was given to fit a shape at", "pick one or more points of the surface");
    for (const std::vector<Vec3d>* list : {&places, &not_places})
        for (const Vec3d& p : *list) require_place("the picked place", p);
    for (const Vec3d& p : not_places)
        if (std::find(places.begin(), places.end(), p) != places.end())
            refuse("the place " + exact(p) + " was given as one of the surface and as one beside it");
    if (!(options.fit.threshold >= 0) || !std::isfinite(options.fit.threshold))
        refuse("the threshold is " + exact(options.fit.threshold) + "; it is a positive number of source units");
    if (!(options.radius >= 0) || !std::isfinite(options.radius))
        refuse("the radius of the neighbourhood is " + exact(options.radius) +
               "; it is a positive number of source units");
    if (!(options.registration >= 0) || !std::isfinite(options.registration))
        refuse("the registration is within " + exact(options.registration) +
               "; it is a positive number of millimetres");
    if (!(options.step >= 0) || !std::isfinite(options.step))
        refuse("the step of growth is " + exact(options.step) + "; it is a positive number of source units");
}

double metres_per_unit(const std::vector<Metadata>& metadata)
{
    const auto system = coordinate_system_of(metadata);
    const bool is_length = system && system->kind != CrsKind::geographic && system->horizontal.unit.is_known();
    return is_length ? system->horizontal.unit.per_unit : 1;
}

class PlacedFit {
public:
    PlacedFit(const PointCloud& cloud, const std::vector<Vec3d>& places, const FitAtOptions& options)
        : cloud_(cloud), tree_(cloud.tree()), places_(places), options_(options), limit_(options.limit)
    {
    }

    FittedPrimitive run(const std::vector<Vec3d>& not_places)
    {
        const auto start = std::chrono::steady_clock::now();
        for (const Vec3d& p : not_places) leave_out(p);
        FittedPrimitive result = best_of_neighbourhoods();
        Primitive& primitive = result.primitive;
        primitive.points = result.points.size();
        if (!result.points.empty()) {
            // A concave outline takes a triangulation of the points, and has as many corners as they need.
            const std::size_t most = options_.outline.kind == OutlineKind::concave ? 100000 : 1000000;
            primitive.bounds = bounds_of(primitive.fit.shape,
                                         cover_points(result.points, primitive.fit.shape, options_.threads,
                                                      part_of(options_.progress, 0.9, 0.95), most),
                                         options_.outline, tree_->info().bounds());
        }
        compare_stations(result);
        primitive.fit.seconds = seconds_since(start);
        return result;
    }

private:
    void compare_stations(FittedPrimitive& result) const
    {
        StationErrorOptions options;
        options.registration = options_.registration / 1000 / metres_per_unit(tree_->info().metadata);
        options.place = places_.front();
        options.threads = options_.threads;
        options.progress = part_of(options_.progress, 0.95, 1);
        add_station_errors(result.points, options, result.agreement, result.primitive);
        if (result.agreement > 1)
            result.notes.push_back("neighbouring points leave the surface together: the errors are " +
                                   brief(result.agreement) + " times those of independent points");
    }

    NearOptions near_options(std::size_t count) const
    {
        NearOptions options;
        options.places = true;
        options.radius = options_.radius;
        options.count = options.radius > 0 ? 0 : count;
        options.limit = limit_;
        return options;
    }

    void leave_out(const Vec3d& place)
    {
        const std::size_t count = options_.count > 0 ? options_.count : place_tuning().neighbourhood.first_points;
        double radius = points_near(cloud_, place, near_options(count)).radius;
        for (const Vec3d& p : places_) radius = std::min(radius, length(p - place) / 2);
        limit_.clips.push_back({Region::sphere(place, radius), true});
    }

    // What the noise of a wide neighbourhood is of may be other surfaces: roofs of a hundred points. So where it is
    // larger than that of the nearest points, the shape of a narrow neighbourhood is followed, too, unless the wide
    // one's is good and has the narrow one's points. The narrow one's is the answer where it is good and the other
    // one's is not, or is elsewhere; where errors are alike at neighbours it is a piece that cannot be followed. Where
    // neither can be, it is what is surely there.
    FittedPrimitive best_of_neighbourhoods()
    {
        LocalFitOptions options = local_options();
        options.progress = part_of(options_.progress, 0, 0.3);
        LocalFit wide = fit_locally(cloud_, places_, options);
        options.progress = part_of(options_.progress, 0.3, 0.4);
        std::optional<LocalFit> narrow = fit_narrowly(cloud_, places_, options, wide);
        FittedPrimitive of_wide = followed(std::move(wide), narrow ? Way::uneven : Way::even, 0.4, narrow ? 0.65 : 0.9);
        if (!narrow) return of_wide;
        const bool is_good = of_wide.primitive.fit.verdict == FitVerdict::good;
        if (is_good && has_points_of(*narrow, of_wide.primitive.fit.shape)) return of_wide;
        FittedPrimitive of_narrow = followed(std::move(*narrow), Way::narrow, 0.65, 0.9);
        return is_good && of_narrow.primitive.fit.verdict != FitVerdict::good ? of_wide : of_narrow;
    }

    // Of a fit's points, as near as noise that differs from place to place leaves them.
    static bool has_points_of(const LocalFit& local, const Shape& shape)
    {
        double squares = 0;
        for (std::size_t i = 0; i < local.near.ids.size(); ++i)
            if (local.fit.is_inlier[i]) squares += std::pow(distance_to(shape, local.near.points.source(i)), 2);
        const double most = place_tuning().following.max_noise_growth * local.fit.noise;
        return squares <= most * most * static_cast<double>(local.fit.inliers);
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

    // The noise of a neighbourhood is that of its nearest points, or there is a narrower one of which it is: then that
    // of a surface, if it is one, differs from place to place, and growth may raise the threshold.
    enum class Way { even, narrow, uneven };

    FittedPrimitive followed(LocalFit local, Way way, double begin, double end)
    {
        FittedPrimitive result{{}, PointSet(tree_), {}, {}, {}, 0, 0, false, 1, {}, {}};
        result.near = std::move(local.near);
        result.local = std::move(local.fit);
        result.notes = std::move(local.notes);
        Primitive& primitive = result.primitive;
        primitive.cloud = tree_->folder().string();
        primitive.estimator = traits_of(options_.fit.estimator).name;
        primitive.fit = result.local;
        primitive.fit.is_inlier.clear();
        noise_ = local.noise / fit_tuning().thresholds.inlier_noises;
        progress_ = part_of(options_.progress, begin, end);
        if (result.local.has_shape()) add_points(local.close, way, result);
        return result;
    }

    void add_points(const NearPoints& close, Way way, FittedPrimitive& result) const
    {
        const ShapeFit& local = result.local;
        std::map<NodeId, std::vector<std::uint32_t>> inliers;
        for (std::size_t i = 0; i < result.near.ids.size(); ++i)
            if (local.is_inlier[i]) {
                inliers[result.near.ids[i].node].push_back(result.near.ids[i].index);
                result.reached.seeds.push_back(result.near.points.source(i));
            }
        for (auto& [node, numbers] : inliers) {
            std::sort(numbers.begin(), numbers.end());
            result.points.set(node, numbers);
        }
        result.reached.shape = local.shape;
        result.reached.threshold = local.threshold;
        result.reached.normal_angle = options_.fit.normal_angle;
        result.reached.turned_angle = angle_of(way);
        result.reached.limit = limit_;
        if (!options_.grow || result.points.empty()) return;
        std::vector<Vec3d> positions;
        for (std::size_t i = 0; i < close.ids.size(); ++i)
            if (const Vec3d p = close.points.source(i); distance_to(local.shape, p) <= local.threshold)
                positions.push_back(p);
        result.step = options_.step > 0 ? options_.step : step_for(local.shape, automatic_step(positions));
        if (!(result.step > 0) || !(local.threshold > 0)) return;
        GrowShapeOptions options;
        options.threshold = local.threshold;
        options.raise_threshold = way == Way::uneven;
        options.turned_angle = result.reached.turned_angle;
        const double noise = options_.fit.threshold > 0 ? std::min(local.noise, local.threshold)
                                                        : local.threshold / fit_tuning().thresholds.inlier_noises;
        options.turned_edge = result.reached.turned_edge = TurnedSurface::edge_for(result.step, noise);
        options.step = result.step;
        options.normal_angle = options_.fit.normal_angle;
        options.most_rounds = options_.rounds;
        options.limit = limit_;
        options.memory_bytes = options_.memory_bytes;
        options.threads = options_.threads;
        options.progress = part_of(progress_, 0, 0.9);
        take(grow_shape(local.shape, result.points, options), way == Way::narrow, result);
    }

    // Errors that are alike at neighbours turn a surface: then it may be turned farther.
    double angle_of(Way way) const
    {
        if (options_.turned_angle > 0) return options_.turned_angle;
        if (options_.fit.threshold > 0) return 4;
        return way == Way::uneven ? pi / 4 : pi / 6;
    }

    // Where the place was picked, points may lie closer than elsewhere; and what stands before a pipe or a tank hides
    // less than half of its width.
    static double step_for(const Shape& shape, double step)
    {
        return std::max(step, std::min(4 * step, narrowest_radius(shape) / 2));
    }

    void take(GrownShape grown, bool is_narrow, FittedPrimitive& result) const
    {
        result.rounds = grown.rounds;
        result.converged = grown.converged;
        if (!grown.fit.has_shape())
            return come_back("the points reached determine no shape (" + std::string(name_of(grown.fit.issue)) + ")",
                             grown.fit.issue, result);
        if (options_.fit.threshold == 0 && grown.fit.noise > tuned_.max_noise_growth * result.local.noise)
            return come_back("its points leave it by " + brief(grown.fit.noise) + ", those around the place by " +
                                 brief(result.local.noise),
                             FitIssue::no_consensus, result);
        if (options_.fit.threshold == 0 && grown.fit.noise > even_spread * grown.threshold)
            return come_back("its points are spread evenly within the threshold, as points of no surface are",
                             FitIssue::no_consensus, result);
        FittedPrimitive followed{result};
        take_grown(std::move(grown), followed);
        if (is_narrow) doubt_few_points(followed);
        const ShapeFit& fit = followed.primitive.fit;
        const bool is_doubted = fit.verdict != FitVerdict::good && result.local.verdict == FitVerdict::good;
        if (options_.fit.threshold == 0 && is_doubted && (is_narrow || fit.issue == FitIssue::no_consensus))
            return come_back(fit.message, fit.issue, result);
        result = std::move(followed);
    }

    // The neighbourhood was chosen by its noise: leaves and twigs have some that look smooth.
    static void doubt_few_points(FittedPrimitive& result)
    {
        ShapeFit& fit = result.primitive.fit;
        if (fit.verdict != FitVerdict::good || result.points.size() >= place_tuning().following.min_narrow_points)
            return;
        doubt(fit, FitIssue::no_consensus,
              "only " + grouped(result.points.size()) +
                  " points lie on it before the noise rises, as some do by chance in a crown of a tree: pick more "
                  "places, or give a threshold");
    }

    // What the shape was before it was followed.
    static void come_back(const std::string& why, FitIssue issue, FittedPrimitive& result)
    {
        result.left_surface = why;
        ShapeFit& fit = result.primitive.fit;
        if (fit.verdict != FitVerdict::good) return;
        doubt(fit, issue,
              "followed through the cloud it left the surface (" + why +
                  "): these are the points around the place alone");
    }

    void take_grown(GrownShape grown, FittedPrimitive& result) const
    {
        result.agreement = grown.agreement;
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
        doubt_other_surface(grown.around, grown.noise, result);
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

    // `wide`: connected, up to a few thresholds from the shape. The points may be a ring or strip of another surface,
    // all of it within a wide threshold, or there by chance.
    void doubt_other_surface(const PointSet& wide, double noise, FittedPrimitive& result) const
    {
        ShapeFit& fit = result.primitive.fit;
        if (fit.verdict != FitVerdict::good || result.points.empty()) return;
        const std::vector<Vec3d> around =
            coarse_points(wide, most_judged, options_.threads, part_of(progress_, 0.9, 0.94));
        const SurfaceEvidence evidence = surface_evidence(fit.shape, spread_of(fit), resolution(), around);
        if (options_.fit.threshold == 0 && !evidence.is_one_surface())
            return doubt(fit, FitIssue::other_surface, evidence.message());
        if (options_.fit.threshold == 0 && is_far_above_close_noise(fit, noise, evidence, result.near))
            return doubt(fit, FitIssue::other_surface,
                         "its points leave it by " + brief(noise) + ", those next to each other at the place by " +
                             brief(noise_) +
                             ": it may hold several surfaces, so take a smaller neighbourhood, or give "
                             "a threshold");
        if (options_.fit.threshold == 0 &&
            fit.threshold > place_tuning().growth.raised_limit * result.local.threshold &&
            !evidence.has_shared_errors())
            return doubt(fit, FitIssue::other_surface,
                         "its points leave it farther and farther the more of them there are, by " + brief(noise) +
                             " at last: it may be a piece of another surface, so take a smaller neighbourhood");
        if (options_.fit.threshold == 0 && fit.noise > tuned_.max_noise_share * fit.threshold)
            return doubt(fit, FitIssue::no_consensus,
                         "the threshold cuts the noise of its points, which may be those of another surface: give a "
                         "larger threshold, or take a smaller neighbourhood");
        if (options_.fit.threshold == 0 && !passes_places(fit, result.near))
            return doubt(fit, FitIssue::no_consensus,
                         "it does not pass through the place that was picked: pick another place of the surface");
        const SurfaceBeyond beyond = surface_beyond(fit.shape, fit.threshold, around);
        const std::string name = traits_of(fit.shape.kind).name;
        if (beyond.is_piece(noise_ > 0 ? noise / noise_ : 0)) {
            doubt(fit, FitIssue::other_surface,
                  "the surface continues smoothly beside these points, but off the " + name +
                      ": they are a ring or strip where it touches a surface of another kind; fit that");
        } else if (const auto other = far_better_kind(result, noise, around)) {
            doubt(fit, FitIssue::other_surface,
                  std::string("a ") + traits_of(*other).name + " fits these points far better than a " + name +
                      ": fit that");
        } else if (beyond.is_by_chance()) {
            doubt(fit, FitIssue::no_consensus,
                  "almost as many points are beside the " + name +
                      " as on it, so it may be there by chance: give a smaller neighbourhood, or a larger threshold "
                      "where the noise is larger");
        }
    }

    // Errors that neighbours share are no part of the noise of the points next to each other; they show there or in the
    // whole.
    bool is_far_above_close_noise(const ShapeFit& fit, double noise, const SurfaceEvidence& whole,
                                  const NearPoints& near) const
    {
        if (!(noise_ > 0) || !(noise > tuned_.max_close_noise * noise_)) return false;
        std::vector<Vec3d> positions;
        for (std::size_t i = 0; i < near.ids.size(); ++i) positions.push_back(near.points.source(i));
        const SurfaceEvidence at_place = surface_evidence(fit.shape, spread_of(fit), resolution(), positions);
        return std::max(whole.bend, at_place.bend) < tuned_.min_shared_bend;
    }

    // A place of another surface may be beside a fit that was narrowed or followed.
    bool passes_places(const ShapeFit& fit, const NearPoints& near) const
    {
        return std::all_of(places_.begin(), places_.end(), [&](const Vec3d& place) {
            double to_cloud = infinity;
            for (std::size_t i = 0; i < near.ids.size(); ++i)
                to_cloud = std::min(to_cloud, length(near.points.source(i) - place));
            return distance_to(fit.shape, place) <= to_cloud + farthest_place(fit);
        });
    }

    double resolution() const
    {
        const Vec3d& scale = tree_->info().grid.scale;
        return std::max({scale[0], scale[1], scale[2]});
    }

    // Where the noise is larger than that around the places, and no threshold allows for it.
    std::optional<ShapeKind> far_better_kind(const FittedPrimitive& result, double noise,
                                             const std::vector<Vec3d>& around) const
    {
        if (options_.fit.threshold > 0 || !(noise_ > 0 && noise > tuned_.max_noise_growth * noise_)) return {};
        ShapeFit fit = result.primitive.fit;
        fit.noise = noise;
        std::vector<Vec3d> near;
        for (std::size_t i = 0; i < result.near.ids.size(); ++i) near.push_back(result.near.points.source(i));
        const auto other = better_kind(fit, near, noise_, part_of(progress_, 0.94, 0.97));
        return other ? other : better_kind(fit, around, noise_, part_of(progress_, 0.97, 1));
    }

    static void doubt(ShapeFit& fit, FitIssue issue, const std::string& message)
    {
        fit.verdict = FitVerdict::doubtful;
        fit.issue = issue;
        fit.message = message;
    }

    const PointCloud& cloud_;
    const std::shared_ptr<const Tree> tree_;
    const std::vector<Vec3d>& places_;
    const FitAtOptions& options_;
    const FollowingTuning& tuned_ = place_tuning().following;
    Selection limit_;
    ProgressFunction progress_;  // of following
    double noise_ = 0;           // of the surface around the places, one standard deviation; 0: unknown
};

}  // namespace

double automatic_step(const std::vector<Vec3d>& inliers)
{
    // The tree of least length that joins the points (Prim); its edges in the order of their lengths join them into
    // ever larger groups.
    constexpr std::size_t most = 4000;
    const std::size_t count = std::min(inliers.size(), most);
    struct Edge {
        double square;
        std::size_t from, to;
    };
    if (count < 2) return 0;
    std::vector<Edge> nearest(count, {infinity, 0, 0}), edges;
    std::vector<bool> joined(count, false);
    for (std::size_t last = 0;;) {
        joined[last] = true;
        std::size_t next = count;
        for (std::size_t i = 0; i < count; ++i) {
            if (joined[i]) continue;
            const double square = squared_distance(inliers[i], inliers[last]);
            if (square < nearest[i].square) nearest[i] = {square, last, i};
            if (next == count || nearest[i].square < nearest[next].square) next = i;
        }
        if (next == count) break;
        edges.push_back(nearest[next]);
        last = next;
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.square < b.square; });
    std::vector<std::size_t> group(count), size(count, 1);
    std::iota(group.begin(), group.end(), std::size_t(0));
    const auto group_of = [&](std::size_t i) {
        while (group[i] != i) i = group[i] = group[group[i]];
        return i;
    };
    for (const Edge& edge : edges) {
        const std::size_t a = group_of(edge.from), b = group_of(edge.to);
        group[a] = b;
        size[b] += size[a];
        if (edge.square > 0 && 10 * size[b] >= 9 * count) return 4 * std::sqrt(edge.square);
    }
    return 0;
}

FittedPrimitive fit_at(const PointCloud& cloud, const std::vector<Vec3d>& places, const std::vector<Vec3d>& not_places,
                       const FitAtOptions& options)
{
    require(places, not_places, options);
    return PlacedFit(cloud, places, options).run(not_places);
}

}  // namespace pcm
