#include "pcm/filter/common_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace pcm {
namespace {

// The integer that `value` is, to a millionth.
std::optional<std::int64_t> whole(double value)
{
    const double rounded = std::round(value);
    if (!(std::fabs(value - rounded) <= 1e-6) || std::fabs(rounded) > 0x1p40) return std::nullopt;
    return static_cast<std::int64_t>(rounded);
}

// Also the largest position must be within a millionth of a step: factors that are nearly whole add up.
std::optional<GridMap> map_between(const GriddedBox& from, const Grid& to)
{
    GridMap map;
    for (std::size_t a = 0; a < 3; ++a) {
        const double ratio = from.grid.scale[a] / to.scale[a];
        const auto factor = whole(ratio), shift = whole((from.grid.offset[a] - to.offset[a]) / to.scale[a]);
        if (!factor || !shift || *factor < 1) return std::nullopt;
        map.factor[a] = *factor;
        map.shift[a] = *shift;
        if (from.box.empty()) continue;
        for (const std::int64_t q : {from.box.min[a], from.box.max[a]}) {
            if (std::fabs(ratio - static_cast<double>(*factor)) * std::fabs(static_cast<double>(q)) > 1e-6)
                return std::nullopt;
            const double place = static_cast<double>(q) * static_cast<double>(*factor) + static_cast<double>(*shift);
            if (place < std::numeric_limits<std::int32_t>::min() || place > std::numeric_limits<std::int32_t>::max())
                return std::nullopt;
        }
    }
    return map;
}

}  // namespace

std::optional<CommonGrid> common_grid(const std::vector<GriddedBox>& clouds)
{
    for (std::size_t like = 0; like < clouds.size(); ++like) {
        CommonGrid common{clouds[like].grid, like, {}};
        for (const GriddedBox& cloud : clouds)
            if (const auto map = map_between(cloud, common.grid)) common.maps.push_back(*map);
        if (common.maps.size() == clouds.size()) return common;
    }
    return std::nullopt;
}

}  // namespace pcm
