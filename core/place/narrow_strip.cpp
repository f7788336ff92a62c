#include "pcm/place/narrow_strip.h"

#include "pcm/cloud/numbers.h"
#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/place/followed_verdict.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/shape_traits.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcm {

double narrowest_spread(const std::vector<Vec3d>& points)
{
    if (points.empty()) return 0;
    const auto count = static_cast<double>(points.size());
    Vec3d middle{};
    for (const Vec3d& p : points) middle = middle + (1 / count) * (p - points.front());
    SquareMatrix<3> moments{};
    for (const Vec3d& p : points) {
        const Vec3d d = p - points.front() - middle;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) moments[a][b] += d[a] * d[b] / count;
    }
    return std::sqrt(std::max(0.0, eigensystem<3>(moments).values[1]));
}

double turn_of_strip(const std::vector<Vec3d>& points, double threshold)
{
    const double width = std::sqrt(12.0) * narrowest_spread(points);
    if (!(width > 0)) return infinity;
    return 6 * threshold * threshold / (width * width + 6 * threshold * width);
}

void doubt_strip(const std::vector<Vec3d>& points, ShapeFit& fit)
{
    if (!traits_of(fit.shape.kind).is_flat()) return;
    const double turn = turn_of_strip(points, fit.threshold);
    if (!(turn > place_tuning().following.max_strip_turn)) return;
    doubt(
        fit, FitIssue::thin_arc,
        "its points are a strip hardly wider than their noise, so those of the surfaces next to it may have turned it "
        "by " +
            brief(turn * 180 / pi) + " degrees: pick a place where the face is wider, or give a threshold");
}

}  // namespace pcm
