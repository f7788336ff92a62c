#include "pcm/primitives/best_kind.h"

#include <algorithm>

namespace pcm {
namespace {

constexpr double least_gain = 2;  // of a kind of higher rank

int rank_of(ShapeKind kind)
{
    return kind == ShapeKind::plane ? 0 : kind == ShapeKind::cylinder || kind == ShapeKind::sphere ? 1 : 2;
}

// Of each fit that takes part, the sum of squared distances up to the threshold.
template <class Test>
std::vector<double> sums_of(const std::vector<ShapeFit>& fits, const Test& takes_part, const FitPoints& points,
                            double threshold)
{
    std::vector<double> sums(fits.size(), 0), distances(fits.size(), threshold);
    for (std::size_t i = 0; i < points.size(); ++i) {
        bool is_near = false;
        for (std::size_t k = 0; k < fits.size(); ++k) {
            if (!takes_part(fits[k])) continue;
            distances[k] = distance_to(fits[k].shape, points.source(i));
            is_near = is_near || distances[k] <= threshold;
        }
        for (std::size_t k = 0; is_near && k < fits.size(); ++k) {
            const double d = std::clamp(distances[k], threshold / 1000, threshold);
            sums[k] += d * d;
        }
    }
    return sums;
}

}  // namespace

std::optional<std::size_t> best_of(const std::vector<ShapeFit>& fits, const FitPoints& points)
{
    const bool any_good =
        std::any_of(fits.begin(), fits.end(), [](const ShapeFit& fit) { return fit.verdict == FitVerdict::good; });
    const auto takes_part = [&](const ShapeFit& fit) {
        return any_good ? fit.verdict == FitVerdict::good : fit.has_shape();
    };
    double threshold = 0;
    for (const ShapeFit& fit : fits)
        if (takes_part(fit)) threshold = std::max(threshold, fit.threshold);
    const std::vector<double> squares = sums_of(fits, takes_part, points, threshold);
    std::optional<std::size_t> best;
    for (int rank = 0; rank <= 2; ++rank) {
        std::optional<std::size_t> of_rank;
        for (std::size_t k = 0; k < fits.size(); ++k)
            if (takes_part(fits[k]) && rank_of(fits[k].shape.kind) == rank &&
                (!of_rank || squares[k] < squares[*of_rank]))
                of_rank = k;
        if (of_rank && (!best || least_gain * squares[*of_rank] < squares[*best])) best = of_rank;
    }
    return best;
}

}  // namespace pcm
