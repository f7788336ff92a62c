#include "pcm/build/nodes/point_sizes.h"

#include "pcm/build/bins/row.h"
#include "pcm/build/nodes/size_codes.h"
#include "pcm/build/nodes/size_loops.h"
#include "pcm/tree/point_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace pcm {
namespace {

// A size is at most this many times the middle one of its group, and this many times that of the bin.
constexpr float most_of_group = 1.5f, most_of_bin = 16;

float middle_of(std::vector<float>& values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Like ==, which would call memcmp.
template <class Coord>
bool same_place(const std::array<Coord, 3>& p, const std::array<Coord, 3>& q)
{
    return !((p[0] ^ q[0]) | (p[1] ^ q[1]) | (p[2] ^ q[2]));
}

void find_distances(const SizeLoops& loops, const std::vector<float>& groups, std::vector<float>& to)
{
    loops.distances(groups.data(), to.size() / size_group, to.data());
}
void find_distances(const SizeLoops& loops, const std::vector<double>& groups, std::vector<float>& to)
{
    loops.distances_in_double(groups.data(), to.size() / size_group, to.data());
}

// Distances for points at different places in Morton order. `place(i, axis)` is a coordinate.
template <class Real, class Place>
std::vector<float> distances(std::size_t points, const Place& place)
{
    const SizeLoops& loops = size_loops();
    const std::size_t groups = (points + size_group - 1) / size_group;
    std::vector<Real> values(groups * 3 * size_group, std::numeric_limits<Real>::infinity());
    for (std::size_t g = 0; g < groups; ++g) {
        const std::size_t first = g * size_group, count = std::min(size_group, points - first);
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t k = 0; k < count; ++k) values[3 * first + a * size_group + k] = place(first + k, a);
    }
    std::vector<float> distance(groups * size_group);
    find_distances(loops, values, distance);
    distance.resize(points);
    std::vector<float> middles(groups);
    loops.middles(distance.data(), points / size_group, middles.data());
    if (points % size_group) {  // the last group may have few points: those before count too
        std::vector<float> last(distance.end() - static_cast<std::ptrdiff_t>(std::min(points, size_group)),
                                distance.end());
        middles.back() = middle_of(last);
    }
    std::vector<float> of_bin = middles;
    const float most = most_of_bin * middle_of(of_bin);
    for (std::size_t i = 0; i < points; ++i)
        distance[i] = std::min({distance[i], most_of_group * middles[i / size_group], most});
    return distance;
}

// The smallest and the largest of values that are not negative, whose bits are in their order: integers that vectors
// compare.
std::pair<float, float> range_of(const std::vector<float>& values)
{
    const auto bits_of = [](float v) {
        std::int32_t bits;
        std::memcpy(&bits, &v, sizeof bits);
        return bits;
    };
    const auto float_of = [](std::int32_t bits) {
        float v;
        std::memcpy(&v, &bits, sizeof v);
        return v;
    };
    std::int32_t low = bits_of(values[0]), high = low;
    for (const float v : values) {
        low = std::min(low, bits_of(v));
        high = std::max(high, bits_of(v));
    }
    return {float_of(low), float_of(high)};
}

}  // namespace

template <class Coord>
std::vector<std::uint8_t> find_sizes(const std::byte* rows, std::size_t points, std::size_t row_bytes, const Grid& grid)
{
    // Points at one place follow one another.
    std::vector<std::uint32_t> of(points);
    std::vector<std::array<Coord, 3>> places;
    places.reserve(points);
    std::array<Coord, 3> low{}, high{};
    for (std::size_t i = 0; i < points; ++i) {
        const std::array<Coord, 3> p = coordinates_of<Coord>(rows + i * row_bytes);
        if (i == 0) low = high = p;
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
        if (places.empty() || !same_place(places.back(), p)) places.push_back(p);
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
    const auto [nearest, farthest] = range_of(distance);
    const SizeCodes code_of(nearest, farthest, least);
    for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = code_of(distance[i]);
    std::vector<std::uint8_t> sizes(points);
    for (std::size_t i = 0; i < points; ++i) sizes[i] = codes[of[i]];
    return sizes;
}

template std::vector<std::uint8_t> find_sizes<std::uint32_t>(const std::byte*, std::size_t, std::size_t, const Grid&);
template std::vector<std::uint8_t> find_sizes<std::uint64_t>(const std::byte*, std::size_t, std::size_t, const Grid&);

}  // namespace pcm
