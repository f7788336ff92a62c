// Which points of other clouds can be near a bin's.
#pragma once

#include "pcm/build/levels/sorted_points.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcm {

// Corners of a bin's box, larger by the distance along each axis, as far as coordinates go.
template <class Coord>
std::pair<Point<Coord>, Point<Coord>> reach_of(const typename SortedPoints<Coord>::Box& box, const Lattice& lattice,
                                               double distance);

// Whether the bin has points in the bucket of a point or in an adjacent one. All that are nearer than the spacing are
// there.
template <class Coord>
class PointsNear {
public:
    PointsNear(typename SortedPoints<Coord>::Reader& points, const Lattice& lattice, int size);
    bool operator()(const Point<Coord>& p) const;

private:
    bool has(const Point<Coord>& bucket) const;
    std::array<int, 3> bucket_;
    std::vector<Point<Coord>> buckets_;
    int table_bits_ = 1;
    std::vector<std::uint32_t> table_;  // hash table: one more than the number of a bucket; 0 if free
};

extern template class PointsNear<std::uint32_t>;
extern template class PointsNear<std::uint64_t>;

}  // namespace pcm
