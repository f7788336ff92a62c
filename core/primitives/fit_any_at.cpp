#include "pcm/primitives/fit_any_at.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace pcm {
namespace {

constexpr double each_number = 0.02, when_doubtful = 0.1;

// Beyond those of a plane.
int more_numbers(ShapeKind kind)
{
    switch (kind) {
        case ShapeKind::plane:
            return 0;
        case ShapeKind::sphere:
            return 1;
        case ShapeKind::cylinder:
            return 2;
        case ShapeKind::cone:
            return 3;
        case ShapeKind::torus:
            return 4;
    }
    return 0;
}

}  // namespace

double unexplained(const ShapeFit& fit, std::size_t points)
{
    if (!fit.has_shape() || points == 0) return std::numeric_limits<double>::infinity();
    const double all = static_cast<double>(points), in = std::min(static_cast<double>(fit.inliers), all);
    const double relative = fit.threshold > 0 ? std::min(fit.rms / fit.threshold, 1.0) : 0;
    return (all - in + in * relative * relative) / all + each_number * more_numbers(fit.shape.kind) +
           (fit.verdict == FitVerdict::doubtful ? when_doubtful : 0);
}

FittedPrimitive fit_any_at(const PointCloud& cloud, const std::vector<Vec3d>& places,
                           const std::vector<Vec3d>& not_places, const std::vector<ShapeKind>& kinds,
                           const FitAtOptions& options)
{
    if (kinds.empty()) throw Error(ErrorCode::invalid_argument, {}, "no kind of shape is given", "name one");
    FitAtOptions trial = options;
    trial.grow = false;
    ShapeKind best_kind = kinds.front();
    double least = std::numeric_limits<double>::infinity();
    std::optional<FittedPrimitive> best;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        trial.fit.kind = kinds[i];
        trial.progress = [&](ProgressUpdate update) {
            update.fraction = (static_cast<double>(i) + update.fraction) / static_cast<double>(kinds.size() + 1);
            return !options.progress || options.progress(update);
        };
        FittedPrimitive found = fit_at(cloud, places, not_places, trial);
        const double left = unexplained(found.primitive.fit, found.near.points.size());
        if (best && !(left < least)) continue;
        least = left;
        best_kind = kinds[i];
        best = std::move(found);
    }
    if (!options.grow || !best->primitive.fit.has_shape()) return std::move(*best);
    FitAtOptions chosen = options;
    chosen.fit.kind = best_kind;
    chosen.progress = [&](ProgressUpdate update) {
        const double done = static_cast<double>(kinds.size());
        update.fraction = (done + update.fraction) / (done + 1);
        return !options.progress || options.progress(update);
    };
    return fit_at(cloud, places, not_places, chosen);
}

}  // namespace pcm
