#include "pcm/detect/other_kind.h"

#include "pcm/place/best_kind.h"
#include "pcm/place/tuning.h"

namespace pcm {
namespace {

std::vector<ShapeKind> kinds_that_bend_more(ShapeKind kind)
{
    if (traits_of(kind).is_flat()) return {ShapeKind::cylinder, ShapeKind::cone};
    if (kind == ShapeKind::cylinder) return {ShapeKind::cone};
    return {};
}

// A sphere lies along the band of a cylinder and takes in points next to it, or along that of a torus. So only points
// on both shapes are compared.
std::optional<ShapeKind> kind_of_band(const ShapeFit& fit, const std::vector<Vec3d>& points)
{
    const FitPoints all = FitPoints::of(points);
    for (const ShapeKind kind : {ShapeKind::cylinder, ShapeKind::torus}) {
        ShapeFitOptions options;
        options.kind = kind;
        options.threshold = fit.threshold;
        const ShapeFit other = fit_shape(all, options);
        if (!other.has_shape()) continue;
        const std::vector<Vec3d> of_both = points_of_both(points, fit, other);
        if (2 * of_both.size() < points.size()) continue;
        const FitPoints both = FitPoints::of(of_both);
        const KindComparison compared(both, std::min(fit.noise, other.noise));
        if (kind == ShapeKind::torus ? compared.evidence(other.shape, fit.shape) > 0
                                     : compared.misfit(other.shape) < compared.misfit(fit.shape))
            return kind;
    }
    return {};
}

// Whether its radius is so large that a scanner's errors may bend a plane as much, as for better_kind().
bool is_wide(const ShapeFit& fit, const std::vector<Vec3d>& points, double noise)
{
    const double radius = traits_of(fit.shape.kind).bend_radius(fit.shape, points.front());
    return !(radius < place_tuning().kinds.max_radius * noise);
}

}  // namespace

std::optional<ShapeKind> other_kind(const ShapeFit& fit, const std::vector<Vec3d>& points)
{
    if (fit.shape.kind == ShapeKind::sphere && fit.noise > 0) return kind_of_band(fit, points);
    const bool is_flat = traits_of(fit.shape.kind).is_flat();
    const FitPoints compared = FitPoints::of(points);
    std::vector<ShapeFit> fits{fit};
    fits.front().verdict = FitVerdict::good;  // all are compared with it
    for (const ShapeKind kind : kinds_that_bend_more(fit.shape.kind)) {
        ShapeFitOptions options;
        options.kind = kind;
        options.threshold = fit.threshold;
        const ShapeFit other = fit_shape(compared, options);
        if (other.has_shape() && !(is_flat && is_wide(other, points, fit.noise))) fits.push_back(other);
    }
    const KindChoice choice = choose_kind(fits, compared);
    if (!choice.best || *choice.best == 0) return std::nullopt;
    return fits[*choice.best].shape.kind;
}

}  // namespace pcm
