#include "pcm/primitives/fit_at.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/primitives/best_kind.h"
#include "pcm/primitives/cover_points.h"
#include "pcm/primitives/local_fit.h"
#include "pcm/primitives/progress_part.h"
#include "pcm/primitives/surface_beyond.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t left_out_points = 500;
constexpr std::size_t most_judged = 20000;  // points, for whether they are a piece of another surface
constexpr double most_noise_grown = 3;      // of a surface whose noise differs from place to place

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
    if (!(options.step >= 0) || !std::isfinite(options.step))
        refuse("the step of growth is " + exact(options.step) + "; it is a positive number of source units");
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
        FittedPrimitive result{{}, PointSet(tree_), {}, {}, {}, 0, 0, false, {}};
        LocalFit local = local_fit();
        result.near = std::move(local.near);
        result.local = std::move(local.fit);
        result.notes = std::move(local.notes);
        Primitive& primitive = result.primitive;
        primitive.cloud = tree_->folder().string();
        primitive.estimator = traits_of(options_.fit.estimator).name;
        primitive.fit = result.local;
        primitive.fit.is_inlier.clear();
        noise_ = local.noise / 3;
        if (result.local.has_shape()) add_points(local.close, result);
        primitive.points = result.points.size();
        if (!result.points.empty()) {
            // A concave outline takes a triangulation of the points, and has as many corners as they need.
            const std::size_t most = options_.outline.kind == OutlineKind::concave ? 100000 : 1000000;
            primitive.bounds = bounds_of(primitive.fit.shape,
                                         cover_points(result.points, primitive.fit.shape, options_.threads,
                                                      part_of(options_.progress, 0.9, 1), most),
                                         options_.outline, tree_->info().bounds());
        }
        primitive.fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return result;
    }

private:
    NearOptions near_options(std::size_t count) const
    {
        NearOptions options;
        options.radius = options_.radius;
        options.count = options.radius > 0 ? 0 : count;
        options.limit = limit_;
        return options;
    }

    void leave_out(const Vec3d& place)
    {
        double radius =
            points_near(cloud_, place, near_options(options_.count > 0 ? options_.count : left_out_points)).radius;
        for (const Vec3d& p : places_) radius = std::min(radius, length(p - place) / 2);
        limit_.clips.push_back({Region::sphere(place, radius), true});
    }

    LocalFit local_fit() const
    {
        LocalFitOptions options;
        options.fit = options_.fit;
        options.kinds = options_.kinds;
        options.radius = options_.radius;
        options.count = options_.count;
        options.limit = limit_;
        options.progress = part_of(options_.progress, 0, 0.4);
        return fit_locally(cloud_, places_, options);
    }

    void add_points(const NearPoints& close, FittedPrimitive& result) const
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
        options.raise_threshold = options_.fit.threshold == 0;
        options.step = result.step;
        options.normal_angle = options_.fit.normal_angle;
        options.most_rounds = options_.rounds;
        options.limit = limit_;
        options.memory_bytes = options_.memory_bytes;
        options.threads = options_.threads;
        options.progress = part_of(options_.progress, 0.4, 0.85);
        take(grow_shape(local.shape, result.points, options), result);
    }

    // Where the place was picked, points may lie closer than elsewhere; and what stands before a pipe or a tank hides
    // less than half of its width.
    static double step_for(const Shape& shape, double step)
    {
        const double width = shape.kind == ShapeKind::torus ? shape.second : shape.radius;
        return std::max(step, std::min(4 * step, width / 2));
    }

    void take(GrownShape grown, FittedPrimitive& result) const
    {
        result.rounds = grown.rounds;
        result.converged = grown.converged;
        if (!grown.fit.has_shape()) {
            const std::string lost = "growth lost the surface (" + std::string(name_of(grown.fit.issue)) +
                                     "): the neighbourhood's points are given";
            result.notes.push_back(lost);
            if (result.primitive.fit.verdict == FitVerdict::good) doubt(result.primitive.fit, grown.fit.issue, lost);
            return;
        }
        if (grown.agreement > 1)
            result.notes.push_back("neighbouring points leave the surface together: the errors are " +
                                   brief(grown.agreement) + " times those of independent points");
        result.points = std::move(grown.points);
        result.reached.shape = grown.followed;
        result.reached.threshold = grown.threshold;
        result.reached.step = result.step;
        keep_few_seeds(result.reached);
        grown.fit.iterations = result.local.iterations;
        if (result.local.issue == FitIssue::no_consensus) {
            grown.fit.verdict = result.local.verdict;
            grown.fit.issue = result.local.issue;
            grown.fit.message = result.local.message;
        }
        if (options_.fit.threshold == 0 && grown.fit.verdict == FitVerdict::good &&
            grown.fit.noise > most_noise_grown * result.local.noise) {
            doubt(grown.fit, FitIssue::no_consensus,
                  "its points leave it by " + brief(grown.fit.noise) + ", those around the place by " +
                      brief(result.local.noise) +
                      ": there is another surface close to it; give a threshold, or a smaller step");
        }
        result.primitive.fit = std::move(grown.fit);
        doubt_other_surface(grown.around, grown.noise, result);
    }

    // `wide`: connected, up to a few thresholds from the shape. The points may be a ring or strip of another surface,
    // all of it within a wide threshold, or there by chance.
    void doubt_other_surface(const PointSet& wide, double noise, FittedPrimitive& result) const
    {
        ShapeFit& fit = result.primitive.fit;
        if (fit.verdict != FitVerdict::good || result.points.empty()) return;
        const std::vector<Vec3d> around =
            coarse_points(wide, most_judged, options_.threads, part_of(options_.progress, 0.85, 0.87));
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

    // Where the noise is larger than that around the places, and no threshold allows for it.
    std::optional<ShapeKind> far_better_kind(const FittedPrimitive& result, double noise,
                                             const std::vector<Vec3d>& around) const
    {
        if (options_.fit.threshold > 0 || !(noise_ > 0 && noise > most_noise_grown * noise_)) return {};
        ShapeFit fit = result.primitive.fit;
        fit.noise = noise;
        std::vector<Vec3d> near;
        for (std::size_t i = 0; i < result.near.ids.size(); ++i) near.push_back(result.near.points.source(i));
        const auto other = better_kind(fit, near, noise_, part_of(options_.progress, 0.87, 0.88));
        return other ? other : better_kind(fit, around, noise_, part_of(options_.progress, 0.88, 0.9));
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
    Selection limit_;
    double noise_ = 0;  // of the surface around the places, one standard deviation; 0: unknown
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
    std::vector<Edge> nearest(count, {std::numeric_limits<double>::infinity(), 0, 0}), edges;
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
