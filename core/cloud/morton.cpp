#include "pcm/cloud/morton.h"

#include "pcm/cloud/geometry.h"

#include <algorithm>
#include <utility>

namespace pcm {

std::vector<std::uint32_t> morton_order(const std::vector<Vec3d>& points)
{
    Box3d box;
    for (const Vec3d& p : points) box.extend(p);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points.size());
    const double side = std::max({box.extent(0), box.extent(1), box.extent(2)});
    constexpr double cells = std::uint64_t(1) << morton_axis_bits;
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::uint64_t key = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const double part = side > 0 ? (points[i][a] - box.min[a]) / side : 0.0;
            const auto cell = part > 0 ? std::min<std::uint64_t>(static_cast<std::uint64_t>(part * cells),
                                                                 (std::uint64_t(1) << morton_axis_bits) - 1)
                                       : 0;
            key |= spread_bits(cell) << a;
        }
        keys[i] = {key, static_cast<std::uint32_t>(i)};
    }
    std::sort(keys.begin(), keys.end());
    std::vector<std::uint32_t> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = keys[i].second;
    return order;
}

}  // namespace pcm
