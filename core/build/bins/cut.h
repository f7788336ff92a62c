// Where to cut a set of points in two: near the median, on a plane that is as round a number as balance allows, so that
// the cells of coarse levels seldom straddle a cut.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
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

// `coordinate(i, axis)` gives the coordinates of `count` points. Depends on the set alone, not on its order. Nothing
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
    Cut<Coord> cut;
    const auto extent = [&](std::size_t a) { return std::ldexp(static_cast<double>(high[a] - low[a]), -finer[a]); };
    for (std::size_t a = 1; a < 3; ++a)
        if (extent(a) > extent(cut.axis)) cut.axis = a;
    if (low[cut.axis] == high[cut.axis]) return std::nullopt;

    // Histograms over ever smaller ranges [from, from + (buckets << shift)) around the median, until some bucket
    // boundary has balance. `below` counts the points left of the range.
    constexpr std::size_t buckets = 1024;
    std::array<std::size_t, buckets + 1> histogram;
    Coord from = low[cut.axis];
    Coord last = high[cut.axis];
    std::size_t below = 0;
    for (;;) {
        int shift = 0;
        while ((static_cast<std::uint64_t>(last - from) >> shift) >= buckets - 1) ++shift;
        const auto aligned = static_cast<Coord>(static_cast<std::uint64_t>(from) >> shift);
        histogram.fill(0);
        for (std::size_t i = 0; i < count; ++i) {
            const Coord c = coordinate(i, cut.axis);
            if (c >= from && c <= last) ++histogram[(static_cast<std::uint64_t>(c) >> shift) - aligned];
        }
        // Boundary b lies before bucket b; cutting there leaves `left` points on the left. Best balance, and among
        // those with balance to spare (45..55 %) the roundest number.
        std::size_t left = below, best_miss = count, best_round = 0, median_bucket = 0;
        bool found_round = false;
        Coord best_value = 0;
        const auto value_at = [&](std::size_t b) {
            return static_cast<Coord>((static_cast<std::uint64_t>(aligned) + b) << shift);
        };
        const std::size_t used = ((static_cast<std::uint64_t>(last) >> shift) - aligned) + 1;
        std::size_t median_below = below;
        for (std::size_t b = 0; b <= used; ++b) {  // histogram[used] is 0
            if (left > 0 && left < count && value_at(b) > low[cut.axis]) {
                const std::size_t miss = left * 2 > count ? left * 2 - count : count - left * 2;
                const bool balanced = miss * 10 <= count;
                const auto round = static_cast<std::size_t>(__builtin_ctzll(value_at(b)));
                const bool better =
                    balanced ? (!found_round || round > best_round || (round == best_round && miss < best_miss))
                             : (!found_round && miss < best_miss);
                if (better) {
                    best_value = value_at(b);
                    best_miss = miss;
                    best_round = round;
                    found_round = found_round || balanced;
                }
            }
            if (left * 2 <= count && b < used) {
                median_bucket = b;
                median_below = left;
            }
            left += histogram[b];
        }
        cut.value = best_value;
        // A third on each side is good enough; so is a single coordinate, which no cut can divide.
        if (best_miss * 3 <= count || shift == 0) return best_miss < count ? std::optional(cut) : std::nullopt;
        below = median_below;
        from = std::max(from, value_at(median_bucket));
        const auto bucket_last = static_cast<Coord>(value_at(median_bucket) + ((Coord(1) << shift) - 1));
        last = std::min(last, bucket_last);
        if (from > last) return std::nullopt;
    }
}

}  // namespace pcm
