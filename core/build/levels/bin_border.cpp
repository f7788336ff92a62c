#include "pcm/build/levels/bin_border.h"

#include <algorithm>
#include <cmath>

namespace pcm {

template <class Coord>
BinBorder<Coord>::BinBorder(const BinNeighbours<Coord>& neighbours, const SortedPoints<Coord>& points,
                            const Lattice& lattice, std::size_t bin, double spacing,
                            const std::vector<std::uint32_t>& near)
    : neighbours_(neighbours), points_(points), squared_(spacing * spacing), near_(near)
{
    const auto& box = points.box(bin);
    inner_low_ = box.high;
    inner_high_ = box.low;
    // Other bins lie outside of the bin's own box, as a rule: then a point as deep in it as the spacing is far from
    // them.
    for (std::size_t a = 0; a < 3; ++a) {
        const double reach = std::ceil(spacing / lattice.scale[a]) + 1;
        if (!(reach < static_cast<double>(box.high[a] - box.low[a]) / 2)) continue;
        inner_low_[a] = box.low[a] + static_cast<Coord>(reach);
        inner_high_[a] = box.high[a] - static_cast<Coord>(reach);
    }
    apart_ = std::none_of(near.begin(), near.end(), [&](std::uint32_t n) { return neighbours.between(bin, n) == 0; });
}

template <class Coord>
bool BinBorder<Coord>::operator()(const Point<Coord>& p) const
{
    bool inside = apart_;
    for (std::size_t a = 0; a < 3; ++a) inside = inside && p[a] > inner_low_[a] && p[a] < inner_high_[a];
    if (inside) return false;
    for (const std::uint32_t n : near_)
        if (neighbours_.to_nearest(p, points_.box(n)) * (1 - distance_margin) < squared_) return true;
    return false;
}

template class BinBorder<std::uint32_t>;
template class BinBorder<std::uint64_t>;

}  // namespace pcm
