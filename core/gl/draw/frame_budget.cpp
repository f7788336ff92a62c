#include "pcm/gl/draw/frame_budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

bool is_nearly_empty(const FrameWork& work)
{
    const BudgetTuning& tuned = gl_tuning().budget;
    return static_cast<double>(work.vertices) < tuned.nearly_empty * static_cast<double>(tuned.min_points);
}

}  // namespace

FrameBudget::Features FrameBudget::features(const FrameWork& work)
{
    return {static_cast<double>(work.vertices), work.splats, work.pixels};
}

double FrameBudget::expected(const FrameWork& work) const
{
    const Features x = features(work);
    return x[0] * costs_[0] + x[1] * costs_[1] + x[2] * costs_[2];
}

void FrameBudget::measured(const FrameWork& work, double milliseconds)
{
    const CostTuning& tuned = gl_tuning().cost;
    last_ms_ = milliseconds;
    expected_ms_ = 0;
    // A nearly empty frame measures the fixed cost: it gives only an upper bound of the cost per point.
    const Features x = features(work);
    if (!(milliseconds > 0) || (is_nearly_empty(work) && (measures_ == 0 || milliseconds > expected(work)))) return;
    if (measures_++ == 0) {
        const Features first_costs{tuned.vertex, tuned.splat, tuned.pixel};
        const double scale = milliseconds / (x[0] * first_costs[0] + x[1] * first_costs[1] + x[2] * first_costs[2]);
        for (std::size_t i = 0; i < 3; ++i) {
            costs_[i] = scale * first_costs[i];
            covariance_[i][i] = tuned.first_deviation * tuned.first_deviation;
        }
        return;
    }
    expected_ms_ = expected(work);
    // Everything relative to the expected time: z are the shares, whose sum is 1.
    Features z{}, gain{};
    for (std::size_t i = 0; i < 3; ++i) {
        z[i] = x[i] * costs_[i] / std::max(expected_ms_, 1e-9);
        covariance_[i][i] =
            std::min(covariance_[i][i] + tuned.change * tuned.change, tuned.first_deviation * tuned.first_deviation);
    }
    double variance = tuned.noise * tuned.noise;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) gain[i] += covariance_[i][j] * z[j];
        variance += z[i] * gain[i];
    }
    const double surprise =
        std::clamp(milliseconds / std::max(expected_ms_, 1e-9) - 1, -tuned.max_surprise, tuned.max_surprise);
    const Features before = gain;  // covariance * z
    for (std::size_t i = 0; i < 3; ++i) {
        gain[i] /= variance;
        costs_[i] *= std::max(tuned.min_factor, 1 + gain[i] * surprise);
    }
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) covariance_[i][j] -= gain[i] * before[j];
}

void FrameBudget::measured_overhead(double milliseconds)
{
    const LateFrameTuning& tuned = gl_tuning().late;
    if (measures_ > tuned.first_frames && expected_ms_ > 0) {
        const double ratio = (last_ms_ + milliseconds) / (expected_ms_ + overhead_ms_);
        margin_ = std::clamp(margin_ * (ratio > margin_ ? tuned.up : tuned.down), tuned.min_margin, tuned.max_margin);
        expected_ms_ = 0;  // each measured frame counts once
    }
    overhead_ms_ += (overhead_ms_ == 0 ? 1.0 : gl_tuning().budget.overhead_share) * (milliseconds - overhead_ms_);
}

std::uint64_t FrameBudget::points(std::uint64_t floor, std::uint64_t ceiling)
{
    const BudgetTuning& tuned = gl_tuning().budget;
    const auto current = static_cast<double>(points_);
    if (goal_ < current)
        points_ = static_cast<std::uint64_t>(goal_);
    else if (goal_ > tuned.min_growth * current)
        points_ = static_cast<std::uint64_t>(std::min({goal_, tuned.max_growth * current, 1e12}));
    points_ =
        std::min(std::max({points_, floor, std::uint64_t(tuned.min_points)}), std::max(ceiling, std::uint64_t(1)));
    return std::min(points_, ceiling);
}

bool FrameBudget::is_to_be_measured(const FrameWork& work) const { return measures_ == 0 && !is_nearly_empty(work); }

double FrameBudget::available(double budget_ms) const
{
    return measures_ == 0 ? std::numeric_limits<double>::infinity() : std::max(0.0, budget_ms / margin_ - overhead_ms_);
}

}  // namespace pcm
