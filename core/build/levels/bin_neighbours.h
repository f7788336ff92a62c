// Which bins of a build are near enough that what one of them chooses matters to the other.
#pragma once

#include "pcm/build/levels/sorted_points.h"

#include <cstddef>
#include <vector>

namespace pcm {

// Bounds of distances are computed with rounding, and decide only by more than this share of their squares.
inline constexpr double distance_margin = 1e-9;

// Squares of distances between points and the boxes of bins, source units. Any thread.
template <class Coord>
class BinNeighbours {
public:
    // `points` must outlive this; all bins are in it when the functions are called.
    BinNeighbours(const SortedPoints<Coord>& points, const Lattice& lattice);

    using Box = typename SortedPoints<Coord>::Box;
    double to_nearest(const Point<Coord>& p, const Box& box) const;
    double to_farthest(const Point<Coord>& p, const Box& box) const;
    double between(std::size_t bin, std::size_t other) const;

    // The bins below `below`, other than `bin` and with points, that may be nearer to it than the spacing. Computed
    // each time: at coarse spacings every bin is near every other, and lists of all would take memory with the square
    // of their number.
    std::vector<std::size_t> of(std::size_t bin, double spacing, std::size_t below) const;

    // All bins with points in groups, so that no two of a group are near each other.
    std::vector<std::vector<std::size_t>> apart(double spacing) const;

private:
    const SortedPoints<Coord>& points_;
    Vec3d squared_scale_;
};

extern template class BinNeighbours<std::uint32_t>;
extern template class BinNeighbours<std::uint64_t>;

}  // namespace pcm
