// Which points of a bin are near other bins.
#pragma once

#include "pcm/build/levels/bin_neighbours.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// Whether a point of the bin may be nearer than the spacing to a point of one of the bins `near` it. All arguments of
// the constructor must outlive this.
template <class Coord>
class BinBorder {
public:
    BinBorder(const BinNeighbours<Coord>& neighbours, const SortedPoints<Coord>& points, const Lattice& lattice,
              std::size_t bin, double spacing, const std::vector<std::uint32_t>& near);
    bool operator()(const Point<Coord>& p) const;

private:
    const BinNeighbours<Coord>& neighbours_;
    const SortedPoints<Coord>& points_;
    const double squared_;
    const std::vector<std::uint32_t>& near_;
    bool apart_;  // no bin near it reaches into its box: points between these are not at the border
    Point<Coord> inner_low_, inner_high_;
};

extern template class BinBorder<std::uint32_t>;
extern template class BinBorder<std::uint64_t>;

}  // namespace pcm
