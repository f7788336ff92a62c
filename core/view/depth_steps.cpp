#include "pcm/view/depth_steps.h"

#include <algorithm>
#include <cstddef>

namespace pcm {
namespace {

constexpr std::size_t least_values = 3, points_of_value = 8;
constexpr double regular_share = 0.75, regular_ratio = 1.2;

// The values of coordinates, ascending; empty where they are too many or too few for steps.
template <class T>
std::vector<T> values_of(const T* coordinates, std::size_t count)
{
    std::vector<T> values;
    // Most clouds have as many values as points: that is seen in the first few of them.
    std::size_t read = 0;
    for (std::size_t end = std::min<std::size_t>(count, 512);; end = std::min(2 * end, count)) {
        values.insert(values.end(), coordinates + read, coordinates + end);
        std::sort(values.begin(), values.end());
        values.erase(std::unique(values.begin(), values.end()), values.end());
        read = end;
        if (2 * values.size() > std::max(end, std::size_t(512)) || values.size() * points_of_value > count) return {};
        if (end == count) break;
    }
    if (values.size() < least_values) values.clear();
    return values;
}

bool is_near(double gap, double other) { return std::max(gap, other) <= regular_ratio * std::min(gap, other); }

// The gaps below each value but the first; 0 for those that are not steps. Empty where the values are not in steps.
template <class T>
std::vector<float> steps_between(const std::vector<T>& values, double scale)
{
    if (values.empty()) return {};
    std::vector<double> gaps;
    for (std::size_t i = 1; i < values.size(); ++i)
        gaps.push_back(scale * static_cast<double>(values[i] - values[i - 1]));
    std::vector<float> steps(gaps.size());
    std::size_t regular = 0;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        if (!(i > 0 && is_near(gaps[i], gaps[i - 1])) && !(i + 1 < gaps.size() && is_near(gaps[i], gaps[i + 1])))
            continue;
        steps[i] = static_cast<float>(gaps[i]);
        ++regular;
    }
    if (static_cast<double>(regular) < regular_share * static_cast<double>(gaps.size())) steps.clear();
    return steps;
}

template <class T>
void add_steps(const T* coordinates, std::size_t count, double scale, float* steps)
{
    const std::vector<T> values = values_of(coordinates, count);
    const std::vector<float> between = steps_between(values, scale);
    if (between.empty()) return;
    for (std::size_t i = 0; i < count; ++i) {
        const auto at =
            static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), coordinates[i]) - values.begin());
        if (at > 0) steps[i] = std::max(steps[i], between[at - 1]);
        if (at < between.size()) steps[i] = std::max(steps[i], between[at]);
    }
}

}  // namespace

std::vector<float> find_depth_steps(const ChunkPositions& positions, const Vec3d& scale,
                                    const std::vector<std::uint32_t>& level_points)
{
    std::vector<float> steps(positions.size(), 0.0f);
    std::size_t first = 0;
    for (const std::uint32_t points : level_points) {
        const std::size_t count = std::min<std::size_t>(points, positions.size() - first);
        for (std::size_t a = 0; a < 3 && count > 0; ++a)
            positions.wide ? add_steps(positions.wide_xyz[a].data() + first, count, scale[a], steps.data() + first)
                           : add_steps(positions.narrow_xyz[a].data() + first, count, scale[a], steps.data() + first);
        first += count;
    }
    if (std::all_of(steps.begin(), steps.end(), [](float s) { return s == 0; })) steps.clear();
    return steps;
}

}  // namespace pcm
