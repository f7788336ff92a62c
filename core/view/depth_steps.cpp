#include "pcm/view/depth_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace pcm {
namespace {

constexpr std::size_t least_values = 3, points_of_value = 8;
constexpr double regular_share = 0.75, regular_ratio = 1.2;
constexpr double least_spacings = 1.5, mixed_share = 0.04;

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

// Coordinates of some points along an axis, and along the two others.
template <class T>
struct Axis {
    const T* along;
    std::array<const T*, 2> across;
    std::size_t count;
    double scale;
    std::array<double, 2> scale_across;

    double distance_across(std::size_t i, std::size_t j) const
    {
        double squared = 0;
        for (std::size_t a = 0; a < 2; ++a) {
            const T p = across[a][i], q = across[a][j];
            const double d = scale_across[a] * static_cast<double>(p > q ? p - q : q - p);
            squared += d * d;
        }
        return std::sqrt(squared);
    }
    double distance_along(std::size_t i, std::size_t j) const
    {
        const T p = along[i], q = along[j];
        return scale * static_cast<double>(p > q ? p - q : q - p);
    }
};

// The numbers of the points in Morton order of some of their coordinates.
template <class T, std::size_t N>
std::vector<std::uint32_t> morton_order(const std::array<const T*, N>& coordinates, std::size_t count)
{
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
        std::size_t axis = 0;  // the one of the highest bit in which they differ
        T bits = 0;
        for (std::size_t a = 0; a < N; ++a) {
            const T other = coordinates[a][i] ^ coordinates[a][j];
            if (bits >= other || bits >= (bits ^ other)) continue;
            axis = a;
            bits = other;
        }
        return coordinates[axis][i] < coordinates[axis][j];
    });
    return order;
}

// The median distance of points that follow one another in Morton order: about that of neighbours.
template <class T>
double usual_distance(const Axis<T>& axis)
{
    const auto order = morton_order<T, 3>({axis.along, axis.across[0], axis.across[1]}, axis.count);
    std::vector<double> distances;
    for (std::size_t k = 1; k < order.size(); ++k)
        distances.push_back(
            std::hypot(axis.distance_along(order[k - 1], order[k]), axis.distance_across(order[k - 1], order[k])));
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

// The share of points with another coordinate along the axis, among those that follow one another in Morton order
// across it and are less than a step apart.
template <class T>
double share_of_mixed(const Axis<T>& axis, double step)
{
    const auto order = morton_order<T, 2>(axis.across, axis.count);
    std::size_t near = 0, mixed = 0;
    for (std::size_t k = 1; k < order.size(); ++k) {
        if (axis.distance_across(order[k - 1], order[k]) > step) continue;
        ++near;
        mixed += axis.along[order[k - 1]] != axis.along[order[k]];
    }
    return near ? static_cast<double>(mixed) / static_cast<double>(near) : 0;
}

template <class T>
void add_steps(const Axis<T>& axis, float* steps)
{
    const std::vector<T> values = values_of(axis.along, axis.count);
    const std::vector<float> between = steps_between(values, axis.scale);
    if (between.empty()) return;
    const auto step = static_cast<double>(*std::max_element(between.begin(), between.end()));
    if (step < least_spacings * usual_distance(axis) || share_of_mixed(axis, step) < mixed_share) return;
    for (std::size_t i = 0; i < axis.count; ++i) {
        const auto at =
            static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), axis.along[i]) - values.begin());
        if (at > 0) steps[i] = std::max(steps[i], between[at - 1]);
        if (at < between.size()) steps[i] = std::max(steps[i], between[at]);
    }
}

template <class T>
void add_steps(const std::array<PageVector<T>, 3>& xyz, std::size_t first, std::size_t count, const Vec3d& scale,
               float* steps)
{
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        add_steps(Axis<T>{xyz[a].data() + first,
                          {xyz[b].data() + first, xyz[c].data() + first},
                          count,
                          scale[a],
                          {scale[b], scale[c]}},
                  steps);
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
        if (count > 0)
            positions.wide ? add_steps(positions.wide_xyz, first, count, scale, steps.data() + first)
                           : add_steps(positions.narrow_xyz, first, count, scale, steps.data() + first);
        first += count;
    }
    if (std::all_of(steps.begin(), steps.end(), [](float s) { return s == 0; })) steps.clear();
    return steps;
}

}  // namespace pcm
