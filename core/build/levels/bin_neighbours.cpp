#include "pcm/build/levels/bin_neighbours.h"

#include <algorithm>

namespace pcm {

template <class Coord>
BinNeighbours<Coord>::BinNeighbours(const SortedPoints<Coord>& points, const Lattice& lattice) : points_(points)
{
    for (std::size_t a = 0; a < 3; ++a) squared_scale_[a] = lattice.scale[a] * lattice.scale[a];
}

template <class Coord>
double BinNeighbours<Coord>::to_nearest(const Point<Coord>& p, const Box& box) const
{
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        double d = 0;
        if (p[a] < box.low[a])
            d = static_cast<double>(box.low[a] - p[a]);
        else if (p[a] > box.high[a])
            d = static_cast<double>(p[a] - box.high[a]);
        sum += d * d * squared_scale_[a];
    }
    return sum;
}

template <class Coord>
double BinNeighbours<Coord>::to_farthest(const Point<Coord>& p, const Box& box) const
{
    const auto distance = [](Coord c, Coord d) { return static_cast<double>(c > d ? c - d : d - c); };
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const double d = std::max(distance(p[a], box.low[a]), distance(p[a], box.high[a]));
        sum += d * d * squared_scale_[a];
    }
    return sum;
}

template <class Coord>
double BinNeighbours<Coord>::between(std::size_t bin, std::size_t other) const
{
    const Box &a = points_.box(bin), &b = points_.box(other);
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        double d = 0;
        if (a.high[k] < b.low[k]) d = static_cast<double>(b.low[k] - a.high[k]);
        if (b.high[k] < a.low[k]) d = static_cast<double>(a.low[k] - b.high[k]);
        sum += d * d * squared_scale_[k];
    }
    return sum;
}

template <class Coord>
std::vector<std::size_t> BinNeighbours<Coord>::of(std::size_t bin, double spacing, std::size_t below) const
{
    const double squared = spacing * spacing;
    std::vector<std::size_t> neighbours;
    for (std::size_t n = 0; n < below; ++n)
        if (n != bin && points_.box(n).points && between(bin, n) * (1 - distance_margin) < squared)
            neighbours.push_back(n);
    return neighbours;
}

// Greedy colouring in the order of the bins.
template <class Coord>
std::vector<std::vector<std::size_t>> BinNeighbours<Coord>::apart(double spacing) const
{
    std::vector<std::vector<std::size_t>> groups;
    std::vector<std::size_t> colour(points_.bins(), 0);
    std::vector<std::size_t> used_by;  // for each colour, the last bin that has a neighbour of it
    for (std::size_t bin = 0; bin < points_.bins(); ++bin) {
        if (points_.box(bin).points == 0) continue;
        for (const std::size_t n : of(bin, spacing, bin)) used_by[colour[n]] = bin;
        std::size_t free = 0;
        while (free < groups.size() && used_by[free] == bin) ++free;
        colour[bin] = free;
        if (free == groups.size()) {
            groups.emplace_back();
            used_by.push_back(points_.bins());
        }
        groups[free].push_back(bin);
    }
    return groups;
}

template class BinNeighbours<std::uint32_t>;
template class BinNeighbours<std::uint64_t>;

}  // namespace pcm
