#include "pcm/detect/refined_shape.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/shape_fit.h"

namespace pcm {

ShapeFit refined_fit(const std::vector<Vec3d>& points, const Shape& start, double threshold)
{
    RefineOptions refine;
    refine.threshold = threshold;
    refine.most_steps = 10;
    return refine_shape(FitPoints::of(points), start, refine);
}

std::optional<Shape> refined_shape(const std::vector<Vec3d>& points, const Shape& start, double threshold)
{
    const ShapeFit fit = refined_fit(points, start, threshold);
    if (!fit.has_shape() || !is_finite(fit.shape.point)) return std::nullopt;
    return fit.shape;
}

}  // namespace pcm
