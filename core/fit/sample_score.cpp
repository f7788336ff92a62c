#include "pcm/fit/sample_score.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/tuning.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t block = 512, first_points = 2048;
// Distances up to this many standard deviations are distinguished by the likelihood.
constexpr double most_deviations = 6;
constexpr std::size_t bins = 240;

}  // namespace

SampleScore::SampleScore(const WorkingPoints& points, const ShapeModel& model, SampleScoring scoring, double threshold,
                         double least_cosine)
    : points_(points),
      model_(model),
      scoring_(scoring),
      threshold_(threshold),
      least_cosine_(points.has_normals() ? least_cosine : -1),
      distances_(block),
      bins_(bins)
{
}

bool SampleScore::fits_normal(const Shape& shape, std::size_t i) const
{
    const Vec3d normal = points_.normal(i);
    return !(dot(normal, normal) > 0) || std::fabs(dot(normal, normal_at(shape, points_.at(i)))) >= least_cosine_;
}

bool SampleScore::is_near(const Shape& shape, std::size_t i, double thresholds) const
{
    double distance = 0;
    model_.distances(shape, &points_.x[i], &points_.y[i], &points_.z[i], 1, &distance);
    return std::fabs(distance) <= thresholds * threshold_ && (least_cosine_ <= 0 || fits_normal(shape, i));
}

std::size_t SampleScore::roughly_near(const Shape& shape, double thresholds)
{
    const std::size_t count = std::min(block, points_.size());
    model_.distances(shape, points_.x.data(), points_.y.data(), points_.z.data(), count, distances_.data());
    std::size_t near = 0;
    for (std::size_t i = 0; i < count; ++i) near += std::fabs(distances_[i]) <= thresholds * threshold_;
    return near;
}

// Distances of the block from there on; those whose normals do not fit are infinite.
std::size_t SampleScore::distances(const Shape& shape, std::size_t first)
{
    const std::size_t count = std::min(block, points_.size() - first);
    model_.distances(shape, &points_.x[first], &points_.y[first], &points_.z[first], count, distances_.data());
    if (least_cosine_ > 0)
        for (std::size_t i = 0; i < count; ++i)
            if (std::fabs(distances_[i]) <= threshold_ && !fits_normal(shape, first + i)) distances_[i] = infinity;
    return count;
}

SampleScore::Value SampleScore::of(const Shape& shape, const Value& best)
{
    return scoring_ == SampleScoring::likelihood ? likelihood(shape) : summed(shape, best);
}

SampleScore::Value SampleScore::summed(const Shape& shape, const Value& best)
{
    Value value;
    const double limit = threshold_ * threshold_, each = 1 / limit;
    const bool many = points_.size() > 4 * first_points, by_count = scoring_ == SampleScoring::count;
    for (std::size_t first = 0; first < points_.size(); first += block) {
        const std::size_t count = distances(shape, first);
        double squares = 0, near = 0;
        block_loops().score(distances_.data(), count, limit, &squares, &near);
        value.inliers += static_cast<std::size_t>(near);
        value.score += by_count ? static_cast<double>(count) - near : squares * each;
        if (!(value.score < best.score)) return value;
        if (many && first + block == first_points) {
            value.of_first = value.score;
            const double chance = fit_tuning().sampling.score_deviations * std::sqrt(static_cast<double>(first_points));
            if (value.score > best.of_first + chance) {
                value.score = infinity;
                return value;
            }
        }
    }
    return value;
}

SampleScore::Value SampleScore::likelihood(const Shape& shape)
{
    Value value;
    std::fill(bins_.begin(), bins_.end(), 0u);
    const double deviation = threshold_ / fit_tuning().thresholds.inlier_noises,
                 scale = bins / (most_deviations * deviation);
    for (std::size_t first = 0; first < points_.size(); first += block) {
        const std::size_t count = distances(shape, first);
        for (std::size_t i = 0; i < count; ++i) {
            const double away = std::fabs(distances_[i]), at = away * scale;
            value.inliers += away <= threshold_;
            if (at < bins) ++bins_[static_cast<std::size_t>(at)];
        }
    }
    const auto n = static_cast<double>(points_.size());
    // Outliers are anywhere within the extent of the points, 2 working units.
    const double density = 1 / (std::sqrt(2 * pi) * deviation), uniform = 0.5;
    std::vector<double> gaussian(bins);
    for (std::size_t i = 0; i < bins; ++i) {
        const double at = (static_cast<double>(i) + 0.5) * most_deviations / bins;
        gaussian[i] = density * std::exp(-at * at / 2);
    }
    double share = std::clamp(static_cast<double>(value.inliers) / n, 0.01, 0.99);
    for (unsigned round = 0; round < 5; ++round) {
        double expected = 0;
        for (std::size_t i = 0; i < bins; ++i)
            expected += bins_[i] * share * gaussian[i] / (share * gaussian[i] + (1 - share) * uniform);
        share = std::clamp(expected / n, 1e-9, 1 - 1e-9);
    }
    std::size_t in_bins = 0;
    for (std::size_t i = 0; i < bins; ++i) {
        value.score -= bins_[i] * std::log(share * gaussian[i] + (1 - share) * uniform);
        in_bins += bins_[i];
    }
    value.score -= static_cast<double>(points_.size() - in_bins) * std::log((1 - share) * uniform);
    return value;
}

}  // namespace pcm
