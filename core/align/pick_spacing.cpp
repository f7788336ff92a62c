#include "pcm/align/pick_spacing.h"

#include <cmath>

namespace pcm {

PickSpacing spacing_at(PointCloud& cloud, const Vec3d& place)
{
    PickSpacing result;
    const auto first = cloud.nearest(place, 1);
    if (first.points.empty()) return result;
    result.distance = first.points.front().distance();
    for (std::size_t k = 8; k <= 512; k *= 8) {  // points at one place are many only where scans were joined
        const auto around = cloud.nearest(first.points.front().position, k);
        for (const Neighbour& point : around.points)
            if (point.squared_distance > 0) {
                result.spacing = point.distance();
                return result;
            }
        if (around.points.size() < k) break;
    }
    return result;
}

double pick_error_of(const std::vector<double>& spacings)
{
    double squares = 0;
    std::size_t count = 0;
    for (const double spacing : spacings)
        if (spacing > 0) {
            squares += spacing / 4 * (spacing / 4);
            ++count;
        }
    return count ? std::sqrt(squares / static_cast<double>(count)) : 0;
}

}  // namespace pcm
