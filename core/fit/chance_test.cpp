#include "pcm/fit/chance_test.h"

#include "pcm/fit/tuning.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcm {
namespace {

// Shares of fewer places are in proportion to the threshold.
constexpr std::size_t places = 1024, least_near = 48;
constexpr double threshold_ratio = 1.189207115;  // between thresholds: the fourth root of 2
constexpr double least_part = 1.0 / 64;

std::vector<double> sorted_distances(const ShapeModel& model, const Shape& shape, const std::vector<double>& x,
                                     const std::vector<double>& y, const std::vector<double>& z)
{
    std::vector<double> sorted(x.size());
    model.distances(shape, x.data(), y.data(), z.data(), x.size(), sorted.data());
    for (double& distance : sorted) distance = std::fabs(distance);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

std::size_t up_to(const std::vector<double>& sorted, double threshold)
{
    return static_cast<std::size_t>(std::upper_bound(sorted.begin(), sorted.end(), threshold) - sorted.begin());
}

double share_within(const std::vector<double>& sorted, double threshold)
{
    const std::size_t near = up_to(sorted, threshold);
    if (near >= least_near) return static_cast<double>(near) / places;
    return static_cast<double>(least_near) / places * std::min(1.0, threshold / sorted[least_near]);
}

}  // namespace

ChanceTest::ChanceTest(const WorkingPoints& points) : points_(points)
{
    const std::array<const std::vector<double>*, 3> from{&points.x, &points.y, &points.z};
    const std::array<std::vector<double>*, 3> to{&x_, &y_, &z_};
    std::array<double, 3> low{}, side{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto [least, most] = std::minmax_element(from[k]->begin(), from[k]->end());
        low[k] = *least;
        side[k] = *most - *least;
    }
    const double largest = *std::max_element(side.begin(), side.end());
    // Multiples of these leave no gaps (Roberts 2018): powers of the inverse of the root of x^4 = x + 1.
    constexpr std::array<double, 3> fraction{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    for (std::size_t k = 0; k < 3; ++k) {
        const double middle = low[k] + side[k] / 2,
                     wide = std::max(side[k], fit_tuning().chance_test.min_side * largest);
        for (std::size_t i = 1; i <= places; ++i) {
            const double at = static_cast<double>(i) * fraction[k];
            to[k]->push_back(middle + wide * (at - std::floor(at) - 0.5));
        }
    }
}

double ChanceTest::share(const ShapeModel& model, const Shape& shape, double threshold) const
{
    return share_within(sorted_distances(model, shape, x_, y_, z_), threshold);
}

double ChanceTest::log_alarms(const ShapeModel& model, double share, double inliers) const
{
    // Some points determine the shape.
    const auto free = static_cast<double>(model.parameters());
    const double n = static_cast<double>(points_.size()) - free, near = inliers - free;
    if (!(n > 0) || !(near > 0)) return 0;
    const double part = std::min(near / n, 1.0);
    if (!(share < part)) return 0;
    // A bound of the binomial tail (Chernoff 1952).
    const double rest = part < 1 ? (1 - part) * std::log((1 - part) / (1 - share)) : 0;
    const double tail = n * (part * std::log(part / share) + rest);
    const ChanceTestTuning& tuned = fit_tuning().chance_test;
    return std::min(0.0, tuned.tests_per_parameter * free * std::log(1 / std::min(share, tuned.max_share)) - tail);
}

double ChanceTest::best_threshold(const ShapeModel& model, const Shape& shape, double most) const
{
    const std::vector<double> box = sorted_distances(model, shape, x_, y_, z_);
    const std::vector<double> near = sorted_distances(model, shape, points_.x, points_.y, points_.z);
    double best = most, least = 0;
    for (double threshold = most; threshold > least_part * most; threshold /= threshold_ratio) {
        const double inliers = static_cast<double>(up_to(near, threshold));
        const double log_false_alarms = log_alarms(model, share_within(box, threshold), inliers);
        if (!(log_false_alarms < least)) continue;
        least = log_false_alarms;
        best = threshold;
    }
    return best;
}

}  // namespace pcm
