#include "pcm/measure/best_plane.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pcm {

BestPlane best_plane(const std::vector<Vec3d>& points)
{
    BestPlane plane;
    const auto count = static_cast<double>(points.size());
    for (const Vec3d& p : points) plane.centre = plane.centre + p;
    plane.centre = plane.centre / count;
    double size = 0;
    for (const Vec3d& p : points) size = std::max(size, largest_magnitude(p - plane.centre));
    std::vector<Vec3d> rows;
    for (const Vec3d& p : points) rows.push_back(size > 0 ? (p - plane.centre) / size : Vec3d{});

    std::array<Vec3d, 3> turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // turn[k]: axis of column k
    constexpr double eps = std::numeric_limits<double>::epsilon();
    for (int sweep = 0; sweep < 60; ++sweep) {
        bool turned = false;
        for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
            double aa = 0, bb = 0, ab = 0;
            for (const Vec3d& row : rows) {
                aa += row[a] * row[a];
                bb += row[b] * row[b];
                ab += row[a] * row[b];
            }
            if (!(std::fabs(ab) > 4 * eps * std::sqrt(aa * bb))) continue;
            turned = true;
            const double zeta = (bb - aa) / (2 * ab);
            const double t = std::copysign(1, zeta) / (std::fabs(zeta) + std::hypot(1, zeta));
            const double c = 1 / std::hypot(1, t), s = c * t;
            for (Vec3d& row : rows) {
                const double x = row[a], y = row[b];
                row[a] = c * x - s * y;
                row[b] = s * x + c * y;
            }
            const Vec3d x = turn[a], y = turn[b];
            turn[a] = c * x - s * y;
            turn[b] = s * x + c * y;
        }
        if (!turned) break;
    }

    std::array<double, 3> extent{};
    for (std::size_t k = 0; k < 3; ++k) {
        for (const Vec3d& row : rows) extent[k] += row[k] * row[k];
        extent[k] = std::sqrt(extent[k]) * size;
    }
    std::array<std::size_t, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return extent[a] > extent[b]; });
    for (std::size_t k = 0; k < 3; ++k) {
        plane.axes[k] = normalised(turn[order[k]]);
        plane.extent[k] = extent[order[k]];
    }
    return plane;
}

}  // namespace pcm
