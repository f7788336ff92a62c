#include "pcm/place/narrow_strip.h"

#include "pcm/cloud/numbers.h"
#include "pcm/cloud/symmetric_eigen.h"

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

}  // namespace pcm
