#include "pcm/place/nearest_answer.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/models/shape_model.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/refit.h"
#include "pcm/place/tuning.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace pcm {

NearLikelihood::NearLikelihood(const Vec3d& place, std::vector<Vec3d> points, double noise)
    : place_(place), points_(std::move(points)), noise_(noise)
{
}

double NearLikelihood::of(const Shape& shape) const
{
    std::vector<double> distances;
    for (const Vec3d& p : points_) distances.push_back(distance_to(shape, p));
    return of(distances, static_cast<double>(model_of(shape.kind).parameters()));
}

double NearLikelihood::of(const Corner& corner) const
{
    if (!corner.edge) return of(corner.widest);
    std::vector<double> distances;
    for (const Vec3d& p : points_)
        distances.push_back(std::max(signed_distance(corner.widest, p), signed_distance(*corner.edge, p)));
    return of(distances, 2 * static_cast<double>(model_of(ShapeKind::plane).parameters()));
}

double NearLikelihood::of(const std::vector<double>& distances, double numbers) const
{
    std::vector<double> peaks;  // density of each point's distance, relative to its peak
    for (const double d : distances) peaks.push_back(std::exp(-d * d / (2 * noise_ * noise_)));
    double sum = 0;
    std::size_t ball = place_tuning().near_place.smallest_ball;
    while (ball > 0 && ball <= points_.size()) {
        const double width = 2 * length(points_[ball - 1] - place_);
        double all = 0;
        for (std::size_t i = 0; i < ball; ++i) all += std::log1p(peaks[i] * width / (noise_ * std::sqrt(2 * pi)));
        const auto count = static_cast<double>(ball);
        sum += (all - numbers * std::log(count) / 2) / count;
        ball *= 2;
    }
    return sum;
}

FittedPrimitive or_nearest(FittedPrimitive found, const Vec3d& place, const NearPoints& near, double noise,
                           const FitOfNearest& fit)
{
    if (found.primitive.fit.verdict == FitVerdict::good || !(noise > 0)) return found;
    const NearPlaceTuning& tuned = place_tuning().near_place;
    const NearLikelihood likelihood(place, near.points.sources(), noise);
    const Vec3d picked = near.ids.empty() ? place : near.points.source(0);
    const auto of = [&](const FittedPrimitive& answer) {
        const ShapeFit& it = answer.primitive.fit;
        return it.has_shape() ? likelihood.of(it.shape) : -infinity;
    };
    const auto has_place = [&](const FittedPrimitive& answer) {
        return distance_to(answer.primitive.fit.shape, picked) <= tuned.max_off * noise;
    };
    const auto corner = corner_at(place, near.points, noise, {});
    const double of_corner = corner ? likelihood.of(*corner) : -infinity;
    double most = of(found) + tuned.min_gain;
    std::size_t best_count = 0;
    std::optional<FittedPrimitive> best;
    for (std::size_t k = 0; k < tuned.sizes; ++k) {
        const auto count = static_cast<std::size_t>(
            std::lround(static_cast<double>(tuned.smallest) * std::pow(tuned.widening, static_cast<double>(k))));
        FittedPrimitive answer = fit(count, false);
        const double gain = of(answer);
        if (!(gain > most) || !has_place(answer) || !is_size_certain(answer.primitive.fit)) continue;
        if (gain <= of_corner && !traits_of(answer.primitive.fit.shape.kind).is_flat()) continue;
        most = gain;
        best_count = count;
        best = std::move(answer);
    }
    if (!best) return found;
    FittedPrimitive followed = fit(best_count, true);
    const std::string note = "the " + grouped(best_count) +
                             " points next to the place were fitted by themselves: the shape of more of them, which is "
                             "not good, explains them worse";
    const bool is_followed = of(followed) >= most - tuned.max_loss && has_place(followed);
    if (is_followed && followed.points.size() >= best->points.size()) {
        followed.notes.push_back(note);
        return followed;
    }
    best->notes.push_back(note);
    come_back("the shape of all its points explains those next to the place worse", FitIssue::no_consensus, *best);
    return std::move(*best);
}

FittedPrimitive or_band(FittedPrimitive found, const Vec3d& place, const NearPoints& near, double noise,
                        const FitAgain& fit)
{
    const ShapeFit& sphere = found.primitive.fit;
    if (sphere.verdict != FitVerdict::doubtful || sphere.shape.kind != ShapeKind::sphere || !(noise > 0)) return found;
    const NearLikelihood likelihood(place, near.points.sources(), noise);
    FittedPrimitive other = fit(place, {ShapeKind::cylinder}, {});
    ShapeFit& cylinder = other.primitive.fit;
    const double radius = sphere.shape.radius;
    const bool is_band =
        std::fabs(cylinder.shape.radius - radius) <= place_tuning().near_place.max_band_radius * radius;
    if (!cylinder.has_shape() || !is_band) return found;
    const double least = likelihood.of(sphere.shape) - place_tuning().near_place.max_band_loss;
    if (!(likelihood.of(cylinder.shape) >= least)) return found;
    doubt(cylinder, FitIssue::thin_arc,
          "a sphere of radius " + brief(radius) +
              " explains the points next to the place as well: they are a band of either, as the rim of a flange is");
    return other;
}

}  // namespace pcm
