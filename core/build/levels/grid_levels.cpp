#include "pcm/build/levels/grid_levels.h"

#include <algorithm>

namespace pcm {
namespace {

// The level of points chosen in cells of `size`.
std::uint8_t level_of(int size, const std::vector<int>& sizes)
{
    if (size < sizes.back()) return static_cast<std::uint8_t>(sizes.size());
    return static_cast<std::uint8_t>(std::max(0, sizes[0] - size));
}

// Calls take(i, size) for each point but the first: the size of the largest cells that part it from the point before,
// -1 for none.
template <class Coord, class Take>
void part(typename SortedPoints<Coord>::Reader& points, const AxisShift& finer, const Take& take)
{
    const std::size_t count = points.size();
    Point<Coord> before = points[0];
    for (std::size_t first = 0; first < count; first += sorted_block) {
        const Point<Coord>* const block = &points[first];
        const std::size_t size = std::min(sorted_block, count - first);
        if (first > 0) take(first, parting_size(before, block[0], finer));
        for (std::size_t i = 1; i < size; ++i) take(first + i, parting_size(block[i - 1], block[i], finer));
        before = block[size - 1];
    }
}

}  // namespace

template <class Coord>
std::array<std::uint32_t, 65> count_first_of_cells(typename SortedPoints<Coord>::Reader& points, const AxisShift& finer,
                                                   int top)
{
    std::array<std::uint32_t, 65> first{};
    first[static_cast<std::size_t>(top)] = 1;
    std::array<std::uint32_t, 65> parted{};  // number of points, keyed by size + 1
    part<Coord>(points, finer, [&](std::size_t, int size) { ++parted[static_cast<std::size_t>(size + 1)]; });
    for (int size = 0; size < 64; ++size)
        first[static_cast<std::size_t>(std::min(size, top))] += parted[static_cast<std::size_t>(size + 1)];
    return first;
}

template <class Coord>
std::vector<std::uint8_t> grid_levels(typename SortedPoints<Coord>::Reader& points, const AxisShift& finer,
                                      const std::vector<int>& sizes)
{
    std::vector<std::uint8_t> levels(points.size());
    if (levels.empty()) return levels;
    std::array<std::uint8_t, 65> level{};  // levels, keyed by size + 1
    for (int size = -1; size < 64; ++size) level[static_cast<std::size_t>(size + 1)] = level_of(size, sizes);
    part<Coord>(points, finer, [&](std::size_t i, int size) { levels[i] = level[static_cast<std::size_t>(size + 1)]; });
    return levels;
}

template <class Coord>
std::vector<std::uint8_t> grid_levels_beside(typename SortedPoints<Coord>::Reader& reader,
                                             const typename SortedPoints<Coord>::Box& box, const Lattice& lattice,
                                             const std::vector<int>& sizes, const GivenLevels<Coord>& given)
{
    // A point is the first of its cell where no point before it is in that cell, and no given one before or after it:
    // the nearest given ones in Morton order decide. Among three points in order, the outer two are parted by the
    // larger of the inner partings.
    std::vector<Point<Coord>> points;
    for (std::size_t i = 0; i < reader.size(); ++i) points.push_back(reader[i]);
    // The size that parts a point from the nearest given one before and after it.
    std::vector<std::int8_t> before(points.size(), 127), after(points.size(), 127);
    Point<Coord> low, high;  // bounds of the points' cells of the first level
    const std::array<int, 3> shifts = lattice.shifts(sizes[0]);
    for (std::size_t a = 0; a < 3; ++a) {
        const std::uint64_t inside = (std::uint64_t(1) << shifts[a]) - 1;
        low[a] = static_cast<Coord>(static_cast<std::uint64_t>(box.low[a]) & ~inside);
        high[a] = static_cast<Coord>(static_cast<std::uint64_t>(box.high[a]) | inside);
    }
    given.list(low, high, 0, sizes.size() - 1, [&](const Point<Coord>* at, std::size_t count) {
        for (std::size_t n = 0; n < count; ++n) {
            const auto place = std::lower_bound(points.begin(), points.end(), at[n], [&](const auto& p, const auto& q) {
                return morton_before(p, q, lattice.finer);
            });
            const auto parted = [&](std::size_t i) {
                return static_cast<std::int8_t>(parting_size(points[i], at[n], lattice.finer));
            };
            const auto i = static_cast<std::size_t>(place - points.begin());
            if (i < points.size()) before[i] = std::min(before[i], parted(i));
            if (i > 0) after[i - 1] = std::min(after[i - 1], parted(i - 1));
        }
    });
    std::vector<std::int8_t> parting(points.size(), 127);  // from the point before
    for (std::size_t i = 1; i < points.size(); ++i) {
        parting[i] = static_cast<std::int8_t>(parting_size(points[i - 1], points[i], lattice.finer));
        before[i] = std::min(before[i], std::max(before[i - 1], parting[i]));
    }
    for (std::size_t i = points.size() - 1; i-- > 0;)
        after[i] = std::min(after[i], std::max(after[i + 1], parting[i + 1]));
    std::vector<std::uint8_t> levels(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        levels[i] = level_of(std::min({before[i], after[i], parting[i]}), sizes);
    return levels;
}

#define PCM_INSTANTIATE(Coord)                                                                                         \
    template std::array<std::uint32_t, 65> count_first_of_cells<Coord>(SortedPoints<Coord>::Reader&, const AxisShift&, \
                                                                       int);                                           \
    template std::vector<std::uint8_t> grid_levels<Coord>(SortedPoints<Coord>::Reader&, const AxisShift&,              \
                                                          const std::vector<int>&);                                    \
    template std::vector<std::uint8_t> grid_levels_beside<Coord>(SortedPoints<Coord>::Reader&,                         \
                                                                 const SortedPoints<Coord>::Box&, const Lattice&,      \
                                                                 const std::vector<int>&, const GivenLevels<Coord>&);
PCM_INSTANTIATE(std::uint32_t)
PCM_INSTANTIATE(std::uint64_t)
#undef PCM_INSTANTIATE

}  // namespace pcm
