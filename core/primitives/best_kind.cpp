#include "pcm/primitives/best_kind.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

double parameters_of(ShapeKind kind)
{
    switch (kind) {
        case ShapeKind::plane:
            return 3;
        case ShapeKind::sphere:
            return 4;
        case ShapeKind::cylinder:
            return 5;
        case ShapeKind::cone:
            return 6;
        case ShapeKind::torus:
            return 7;
    }
    return 0;
}

}  // namespace

std::optional<std::size_t> best_of(const std::vector<ShapeFit>& fits, const FitPoints& points)
{
    const bool any_good =
        std::any_of(fits.begin(), fits.end(), [](const ShapeFit& fit) { return fit.verdict == FitVerdict::good; });
    const auto takes_part = [&](const ShapeFit& fit) {
        return any_good ? fit.verdict == FitVerdict::good : fit.has_shape();
    };
    double threshold = 0, noise = std::numeric_limits<double>::infinity();
    for (const ShapeFit& fit : fits)
        if (takes_part(fit)) {
            threshold = std::max(threshold, fit.threshold);
            noise = std::min(noise, fit.noise);
        }
    noise = std::max(noise, threshold / 1e6);
    std::optional<std::size_t> best;
    double least = 0;
    for (std::size_t k = 0; k < fits.size(); ++k) {
        if (!takes_part(fits[k])) continue;
        double cost = parameters_of(fits[k].shape.kind) * std::log(static_cast<double>(points.size()));
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double d = std::min(distance_to(fits[k].shape, points.source(i)), threshold);
            cost += noise > 0 ? (d / noise) * (d / noise) : 0;
        }
        if (!best || cost < least) {
            best = k;
            least = cost;
        }
    }
    return best;
}

}  // namespace pcm
