#include "pcm/build/levels/bin_neighbours.h"

#include <algorithm>
#include <limits>

namespace pcm {

template <class Coord>
BinNeighbours<Coord>::BinNeighbours(const SortedPoints<Coord>& points, const Lattice& lattice)
    : points_(points), scale_(lattice.scale), place_(points.bins(), 0)
{
    for (std::size_t a = 0; a < 3; ++a) squared_scale_[a] = scale_[a] * scale_[a];
    for (std::size_t bin = 0; bin < points_.bins(); ++bin) {
        const Box& box = points_.box(bin);
        if (box.points == 0) continue;
        for (std::size_t a = 0; a < 3; ++a) origin_[a] = bins_.empty() ? box.low[a] : std::min(origin_[a], box.low[a]);
        place_[bin] = static_cast<std::uint32_t>(bins_.size());
        bins_.push_back(static_cast<std::uint32_t>(bin));
    }
    Box3d around;
    for (const std::uint32_t bin : bins_) {
        boxes_.push_back(reach(bin, 0));
        around.extend(boxes_.back());
    }
    for (std::size_t a = 0; a < 3 && !around.empty(); ++a)
        rounding_ = std::max(rounding_, 8 * std::numeric_limits<double>::epsilon() * around.max[a]);
    tree_ = BoxTree(boxes_);
}

// The box of a bin, larger by the spacing: boxes of bins that are nearer touch it.
template <class Coord>
Box3d BinNeighbours<Coord>::reach(std::size_t bin, double spacing) const
{
    const Box& box = points_.box(bin);
    const double more = spacing * (1 + distance_margin) + rounding_;
    Box3d result;
    for (std::size_t a = 0; a < 3; ++a) {
        result.min[a] = static_cast<double>(box.low[a] - origin_[a]) * scale_[a] - more;
        result.max[a] = static_cast<double>(box.high[a] - origin_[a]) * scale_[a] + more;
    }
    return result;
}

// The bins nearer than the spacing, of those at places of bins_ that touch its reach.
template <class Coord>
std::vector<std::uint32_t> BinNeighbours<Coord>::near(std::size_t bin, const std::vector<std::uint32_t>& touching,
                                                      double spacing) const
{
    std::vector<std::uint32_t> found;
    for (const std::uint32_t place : touching) {
        const std::uint32_t other = bins_[place];
        if (other != bin && between(bin, other) * (1 - distance_margin) < spacing * spacing) found.push_back(other);
    }
    return found;
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
auto BinNeighbours<Coord>::lists(double spacing) const -> std::optional<Lists>
{
    Lists lists(points_.bins());
    std::size_t pairs = 0;
    for (const std::uint32_t bin : bins_) {
        lists[bin] = near(bin, tree_.touching(reach(bin, spacing)), spacing);
        pairs += lists[bin].size();
        if (pairs > most_near * bins_.size()) return std::nullopt;
    }
    return lists;
}

// Greedy colouring in the order of the bins.
template <class Coord>
std::vector<std::vector<std::size_t>> BinNeighbours<Coord>::apart(const Lists& lists) const
{
    std::vector<std::vector<std::size_t>> groups;
    std::vector<std::size_t> colour(points_.bins(), 0);
    std::vector<std::size_t> used_by;  // for each colour, the last bin that has a neighbour of it
    for (const std::uint32_t bin : bins_) {
        for (const std::uint32_t n : lists[bin])
            if (n < bin) used_by[colour[n]] = bin;
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
