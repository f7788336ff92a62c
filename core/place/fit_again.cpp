#include "pcm/place/fit_again.h"

#include "pcm/fit/models/shape_model.h"
#include "pcm/place/best_kind.h"
#include "pcm/place/cover_points.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/own_points.h"
#include "pcm/place/radius_step.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace pcm {
namespace {

constexpr int most_ranks = 2;                // cone and torus
constexpr std::size_t enough_points = 1000;  // points for which kinds are compared

bool is_good(const FittedPrimitive& found) { return found.primitive.fit.verdict == FitVerdict::good; }

}  // namespace

FittedPrimitive or_elbow(FittedPrimitive found, const Vec3d& place, const Vec3d& on_bend,
                         const std::vector<ShapeKind>& kinds, const FitAgain& fit)
{
    if (is_good(found)) return found;
    FittedPrimitive elbow = fit(on_bend, kinds, {});
    const ShapeFit& torus = elbow.primitive.fit;
    const bool has_place =
        elbow.part && elbow.part->has(place) && distance_to(torus.shape, place) <= farthest_place(torus);
    if (!is_good(elbow) || torus.shape.kind != ShapeKind::torus || !has_place) return found;
    elbow.notes.push_back(
        "the place lies next to where the pipe begins to bend: the elbow was fitted farther along it");
    return elbow;
}

FittedPrimitive or_pipe(FittedPrimitive found, const Vec3d& place, const FitAgain& fit)
{
    if (is_good(found) || !found.part || found.part->has(place)) return found;
    FittedPrimitive pipe = fit(place, {ShapeKind::cylinder}, {});
    if (!is_good(pipe) || pipe.primitive.fit.shape.kind != ShapeKind::cylinder) return found;
    pipe.notes.push_back("the place lies on the pipe behind an elbow: the pipe was fitted alone");
    return pipe;
}

FittedPrimitive or_higher_kind(FittedPrimitive found, const Vec3d& place, double most_noise,
                               const std::vector<ShapeKind>& kinds, const FitAgain& fit, unsigned threads)
{
    const ShapeFit& first = found.primitive.fit;
    if (is_good(found) || kinds.size() < 2 || !first.has_shape() || first.noise > most_noise) return found;
    const bool is_of_other = first.issue == FitIssue::no_consensus || first.issue == FitIssue::other_surface;
    if (!is_of_other || found.points.size() < place_tuning().following.min_narrow_points) return found;
    const int rank = model_of(first.shape.kind).rank;
    // What is not followed as a plane may be a wide sphere or cylinder. Else it may be terrain.
    if (rank == 0 && found.left_surface.empty()) return found;
    const int most_rank = rank == 0 ? 1 : most_ranks;
    const std::size_t least =
        rank == 0 ? place_tuning().following.min_small_points : place_tuning().growth.min_swept_points;
    std::optional<FittedPrimitive> best;
    for (const ShapeKind kind : kinds) {
        if (model_of(kind).rank <= rank || model_of(kind).rank > most_rank) continue;
        FittedPrimitive next = fit(place, {kind}, {});
        if (!is_good(next) || next.primitive.fit.shape.kind != kind) continue;
        if (next.points.size() < least) continue;
        if (!explains_better(next.primitive.fit, first.shape,
                             random_points(own_points(next, threads), enough_points, threads, {})))
            continue;
        if (!best || next.points.size() > best->points.size()) best = std::move(next);
    }
    if (!best) return found;
    best->notes.push_back(std::string("first taken for a ") + traits_of(first.shape.kind).name +
                          ", which cannot be followed through the cloud");
    return std::move(*best);
}

FittedPrimitive or_one_radius(FittedPrimitive found, const Vec3d& place, double spread, const FitAgain& fit,
                              unsigned threads)
{
    const RadiusStepTuning& tuned = place_tuning().radius_steps;
    ShapeFit& whole = found.primitive.fit;
    if (whole.shape.kind != ShapeKind::cylinder || found.points.empty()) return found;
    const Shape cylinder = whole.shape;
    const double least = std::max(tuned.min_spreads * spread, tuned.min_radii * cylinder.radius);
    const auto step =
        radius_step(cylinder, whole.noise, least, place, random_points(found.points, tuned.points, threads));
    if (!step) return found;
    if (step->has_place) {
        const double way = dot(place - cylinder.point, cylinder.axis);
        std::vector<Region::Plane> ends;  // normal . d + offset >= 0, d from the place
        if (std::isfinite(step->from)) ends.push_back({cylinder.axis, way - step->from});
        if (std::isfinite(step->to)) ends.push_back({-1 * cylinder.axis, step->to - way});
        FittedPrimitive pipe = fit(place, {ShapeKind::cylinder}, Clip{Region::convex(place, ends), false});
        if (is_good(pipe) && pipe.primitive.fit.shape.kind == ShapeKind::cylinder) {
            pipe.notes.push_back("followed as far as the radius does not change: behind, it is about " +
                                 brief(step->beyond));
            return pipe;
        }
    }
    if (is_good(found))
        doubt(whole, FitIssue::other_surface,
              "the radius changes along it, from about " + brief(step->radius) + " to " + brief(step->beyond) +
                  ": pick a place farther from where it does, or take a smaller neighbourhood");
    return found;
}

}  // namespace pcm
