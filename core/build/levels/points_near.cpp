#include "pcm/build/levels/points_near.h"

#include "pcm/build/levels/cells.h"

#include <cmath>
#include <limits>

namespace pcm {

template <class Coord>
std::pair<Point<Coord>, Point<Coord>> reach_of(const typename SortedPoints<Coord>::Box& box, const Lattice& lattice,
                                               double distance)
{
    Point<Coord> low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        const double reach = std::ceil(distance / lattice.scale[a]) + 1;
        const auto most = std::numeric_limits<Coord>::max();
        const auto steps = reach < static_cast<double>(most) ? static_cast<Coord>(reach) : most;
        low[a] = box.low[a] > steps ? box.low[a] - steps : 0;
        high[a] = most - box.high[a] > steps ? box.high[a] + steps : most;
    }
    return {low, high};
}

template <class Coord>
PointsNear<Coord>::PointsNear(typename SortedPoints<Coord>::Reader& points, const Lattice& lattice, int size)
    : bucket_(all_shifts(lattice, size + bucket_bits(lattice)))
{
    const auto shifts = lattice.shifts(size + bucket_bits(lattice));
    for (std::size_t i = 0; i < points.size(); i = points.end_of_cell(i, points.size(), shifts))
        buckets_.push_back(cell_of(points[i], bucket_));
    while ((std::size_t(1) << table_bits_) < 2 * buckets_.size()) ++table_bits_;
    table_.assign(std::size_t(1) << table_bits_, 0);
    for (std::size_t b = 0; b < buckets_.size(); ++b) {
        std::size_t i = hash_of(buckets_[b], table_bits_);
        while (table_[i]) i = (i + 1) & (table_.size() - 1);
        table_[i] = static_cast<std::uint32_t>(b + 1);
    }
}

template <class Coord>
bool PointsNear<Coord>::has(const Point<Coord>& bucket) const
{
    for (std::size_t i = hash_of(bucket, table_bits_); table_[i]; i = (i + 1) & (table_.size() - 1))
        if (same(buckets_[table_[i] - 1], bucket)) return true;
    return false;
}

template <class Coord>
bool PointsNear<Coord>::operator()(const Point<Coord>& p) const
{
    const Point<Coord> own = cell_of(p, bucket_);
    if (has(own)) return true;
    for (int n = 0; n < 27; ++n) {
        const Point<Coord> at{static_cast<Coord>(own[0] + static_cast<Coord>(n % 3 - 1)),
                              static_cast<Coord>(own[1] + static_cast<Coord>(n / 3 % 3 - 1)),
                              static_cast<Coord>(own[2] + static_cast<Coord>(n / 9 - 1))};
        if (has(at)) return true;
    }
    return false;
}

template std::pair<Point<std::uint32_t>, Point<std::uint32_t>> reach_of<std::uint32_t>(
    const SortedPoints<std::uint32_t>::Box&, const Lattice&, double);
template std::pair<Point<std::uint64_t>, Point<std::uint64_t>> reach_of<std::uint64_t>(
    const SortedPoints<std::uint64_t>::Box&, const Lattice&, double);
template class PointsNear<std::uint32_t>;
template class PointsNear<std::uint64_t>;

}  // namespace pcm
