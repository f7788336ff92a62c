// Where to cut a set of points in two: near the median, on a plane that is as round a number as balance allows, so that
// the cells of coarse levels seldom straddle a cut.
#pragma once

#include "pcm/cloud/geometry.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace pcm {

template <class Coord>
struct Cut {
    std::size_t axis = 0;
    Coord value = 0;  // points with a smaller coordinate go left
};

// How many bits finer an axis' grid is than the coarsest axis' (0 for all three on most clouds): lengths on different
// axes compare after shifting them down by this.
using AxisShift = std::array<int, 3>;

AxisShift axis_shift(const Grid& grid);

// The axis along which the box from `low` to `high` is longest; of equal ones the first.
template <class Coord>
std::size_t longest_axis(const std::array<Coord, 3>& low, const std::array<Coord, 3>& high, const AxisShift& finer);

// The search for a cut along one axis, for choose_cut(). It counts the coordinates in buckets of ever smaller ranges
// around the median, until some boundary between buckets has balance.
template <class Coord>
class CutSearch {
public:
    // `count` coordinates from `low` to `high`, low < high.
    CutSearch(std::size_t count, Coord low, Coord high);
    // Each round: add() for every coordinate, then finish_round(), which is true when the search has ended.
    void add(Coord c)
    {
        if (c >= from_ && c <= last_) ++histogram_[(static_cast<std::uint64_t>(c) >> shift_) - aligned_];
    }
    bool finish_round();
    // The value to cut at; absent when the coordinates cannot be divided.
    const std::optional<Coord>& value() const { return value_; }

private:
    static constexpr std::size_t buckets = 1024;

    void start_round();
    Coord boundary(std::size_t bucket) const  // the first coordinate of the bucket
    {
        return static_cast<Coord>((static_cast<std::uint64_t>(aligned_) + bucket) << shift_);
    }

    const std::size_t count_;
    const Coord low_;
    Coord from_, last_;          // the range of this round, both inclusive
    std::size_t below_ = 0;      // coordinates below the range
    int shift_ = 0;              // a bucket is 2^shift_ wide
    std::uint64_t aligned_ = 0;  // from_ >> shift_: bucket 0
    std::array<std::size_t, buckets + 1> histogram_;
    std::optional<Coord> value_;
};

// Where to cut `count` coordinates from `low` to `high`, see choose_cut().
template <class Coord>
std::optional<Coord> choose_cut_of(const Coord* coordinates, std::size_t count, Coord low, Coord high)
{
    if (low == high) return std::nullopt;
    CutSearch<Coord> search(count, low, high);
    do
        for (std::size_t i = 0; i < count; ++i) search.add(coordinates[i]);
    while (!search.finish_round());
    return search.value();
}

// `coordinate(i, axis)` gives the coordinates of `count` points. Depends on the set alone, not on its order. Absent
// when all points coincide. Both sides get at least one point; unless many points share one coordinate each gets at
// least a third.
template <class Coord, class Access>
std::optional<Cut<Coord>> choose_cut(std::size_t count, const AxisShift& finer, const Access& coordinate)
{
    if (count < 2) return std::nullopt;
    std::array<Coord, 3> low, high;
    for (std::size_t a = 0; a < 3; ++a) low[a] = high[a] = coordinate(0, a);
    for (std::size_t i = 1; i < count; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            const Coord c = coordinate(i, a);
            low[a] = std::min(low[a], c);
            high[a] = std::max(high[a], c);
        }
    const std::size_t axis = longest_axis(low, high, finer);
    if (low[axis] == high[axis]) return std::nullopt;
    CutSearch<Coord> search(count, low[axis], high[axis]);
    do
        for (std::size_t i = 0; i < count; ++i) search.add(coordinate(i, axis));
    while (!search.finish_round());
    if (!search.value()) return std::nullopt;
    return Cut<Coord>{axis, *search.value()};
}

extern template std::size_t longest_axis(const std::array<std::uint32_t, 3>&, const std::array<std::uint32_t, 3>&,
                                         const AxisShift&);
extern template std::size_t longest_axis(const std::array<std::uint64_t, 3>&, const std::array<std::uint64_t, 3>&,
                                         const AxisShift&);
extern template class CutSearch<std::uint32_t>;
extern template class CutSearch<std::uint64_t>;

}  // namespace pcm
