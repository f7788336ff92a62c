#include "pcm/build/nodes/point_sizes.h"

#include "pcm/build/bins/row.h"
#include "pcm/tree/point_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

constexpr std::size_t group_points = 32;
constexpr std::size_t neighbours = 4;
// A size is at most this many times the middle one of its group, and this many times that of the bin.
constexpr float most_of_group = 1.5f, most_of_bin = 16;

template <class Real>
constexpr Real infinite = std::numeric_limits<Real>::infinity();

template <class Real>
using Lanes = std::array<Real, group_points>;

// Points that follow one another in Morton order. The last group is filled up with points infinitely far away.
template <class Real>
using Group = std::array<Lanes<Real>, 3>;

// The squares of the distances of a group's points to the nearest points found so far, nearest first.
template <class Real>
using Nearest = std::array<Lanes<Real>, neighbours>;

// Offers the points of `to` to those of `from`, all of which are updated at once. Written so that it becomes vector
// instructions.
template <class Real>
void offer(const Group<Real>& from, const Group<Real>& to, Nearest<Real>& nearest)
{
    const bool own = &from == &to;
    for (std::size_t j = 0; j < group_points; ++j) {
        const Real x = to[0][j], y = to[1][j], z = to[2][j];
        Lanes<Real> d;
        for (std::size_t k = 0; k < group_points; ++k) {
            const Real dx = from[0][k] - x, dy = from[1][k] - y, dz = from[2][k] - z;
            d[k] = dx * dx + dy * dy + dz * dz;
        }
        if (own) d[j] = infinite<Real>;
        for (Lanes<Real>& rank : nearest)
            for (std::size_t k = 0; k < group_points; ++k) {
                const Real nearer = std::min(rank[k], d[k]);  // a NaN, of two points infinitely far away, is not taken
                d[k] = std::max(rank[k], d[k]);
                rank[k] = nearer;
            }
    }
}

// The distance to the fourth neighbour, or to the last one that there is; 0 without any.
template <class Real>
float distance_of(const Nearest<Real>& nearest, std::size_t k)
{
    for (std::size_t rank = neighbours; rank-- > 0;)
        if (nearest[rank][k] < infinite<Real>) return static_cast<float>(std::sqrt(nearest[rank][k]));
    return 0;
}

float middle_of(std::vector<float>& values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Of points at different places in Morton order. `place(i, axis)` is a coordinate.
template <class Real, class Place>
std::vector<float> distances(std::size_t points, const Place& place)
{
    std::vector<Group<Real>> groups((points + group_points - 1) / group_points);
    for (std::size_t i = 0; i < groups.size() * group_points; ++i)
        for (std::size_t a = 0; a < 3; ++a)
            groups[i / group_points][a][i % group_points] = i < points ? place(i, a) : infinite<Real>;
    std::vector<float> distance(points), of_group, middles;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        Nearest<Real> nearest;
        for (Lanes<Real>& rank : nearest) rank.fill(infinite<Real>);
        for (std::size_t other = g > 0 ? g - 1 : 0; other <= std::min(g + 1, groups.size() - 1); ++other)
            offer(groups[g], groups[other], nearest);
        const std::size_t first = g * group_points, count = std::min(group_points, points - first);
        for (std::size_t k = 0; k < count; ++k) distance[first + k] = distance_of(nearest, k);
        // The last group may have few points: those before count too.
        const auto end = distance.begin() + static_cast<std::ptrdiff_t>(first + count);
        of_group.assign(end - static_cast<std::ptrdiff_t>(std::min(first + count, group_points)), end);
        middles.push_back(middle_of(of_group));
    }
    of_group = middles;
    const float most = most_of_bin * middle_of(of_group);
    for (std::size_t i = 0; i < points; ++i)
        distance[i] = std::min({distance[i], most_of_group * middles[i / group_points], most});
    return distance;
}

}  // namespace

template <class Coord>
std::vector<std::uint8_t> find_sizes(const std::byte* rows, std::size_t points, std::size_t row_bytes, const Grid& grid)
{
    // Points at one place follow one another.
    std::vector<std::uint32_t> of(points);
    std::vector<std::array<Coord, 3>> places;
    std::array<Coord, 3> low{}, high{};
    for (std::size_t i = 0; i < points; ++i) {
        const std::array<Coord, 3> p = coordinates_of<Coord>(rows + i * row_bytes);
        if (i == 0) low = high = p;
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
        if (places.empty() || places.back() != p) places.push_back(p);
        of[i] = static_cast<std::uint32_t>(places.size() - 1);
    }
    if (places.size() < 2) return std::vector<std::uint8_t>(points, unknown_size);
    // Distances are in units of the largest grid step, so that no square leaves the range of the numbers. Floats hold a
    // narrow bin's coordinates exactly.
    const double unit = std::max({grid.scale[0], grid.scale[1], grid.scale[2]});
    std::uint64_t steps = 0;
    for (std::size_t a = 0; a < 3; ++a) steps = std::max(steps, static_cast<std::uint64_t>(high[a] - low[a]));
    const auto distances_as = [&](auto real) {
        using Real = decltype(real);
        return distances<Real>(places.size(), [&](std::size_t i, std::size_t a) {
            return static_cast<Real>(places[i][a] - low[a]) * static_cast<Real>(grid.scale[a] / unit);
        });
    };
    const std::vector<float> distance = steps < (1u << 24) ? distances_as(float()) : distances_as(double());
    const double least = least_point_size(grid) / unit;
    std::vector<std::uint8_t> codes(places.size());
    for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = size_code(static_cast<double>(distance[i]), least);
    std::vector<std::uint8_t> sizes(points);
    for (std::size_t i = 0; i < points; ++i) sizes[i] = codes[of[i]];
    return sizes;
}

template std::vector<std::uint8_t> find_sizes<std::uint32_t>(const std::byte*, std::size_t, std::size_t, const Grid&);
template std::vector<std::uint8_t> find_sizes<std::uint64_t>(const std::byte*, std::size_t, std::size_t, const Grid&);

}  // namespace pcm
