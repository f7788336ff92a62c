#include "pcm/build/bins/cut.h"

#include <cmath>

namespace pcm {

AxisShift axis_shift(const Grid& grid)
{
    AxisShift finer{0, 0, 0};
    const double coarsest = std::max({grid.scale[0], grid.scale[1], grid.scale[2]});
    for (std::size_t a = 0; a < 3; ++a) finer[a] = static_cast<int>(std::floor(std::log2(coarsest / grid.scale[a])));
    return finer;
}

template <class Coord>
std::size_t longest_axis(const std::array<Coord, 3>& low, const std::array<Coord, 3>& high, const AxisShift& finer)
{
    const auto extent = [&](std::size_t a) { return std::ldexp(static_cast<double>(high[a] - low[a]), -finer[a]); };
    std::size_t longest = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (extent(a) > extent(longest)) longest = a;
    return longest;
}

template <class Coord>
CutSearch<Coord>::CutSearch(std::size_t count, Coord low, Coord high)
    : count_(count), low_(low), from_(low), last_(high)
{
    start_round();
}

template <class Coord>
void CutSearch<Coord>::start_round()
{
    shift_ = 0;
    while ((static_cast<std::uint64_t>(last_ - from_) >> shift_) >= buckets - 1) ++shift_;
    aligned_ = static_cast<std::uint64_t>(from_) >> shift_;
    histogram_.fill(0);
}

template <class Coord>
bool CutSearch<Coord>::finish_round()
{
    // Boundary b lies before bucket b; a cut there leaves `left` points on the left. The best is that of the best
    // balance, and among those with balance to spare (45..55 %) the roundest number. `miss` is twice the distance of
    // `left` from half of the points.
    std::size_t left = below_, best_miss = count_, best_round = 0;
    std::size_t median_bucket = 0, median_below = below_;
    bool found_balanced = false;
    const std::size_t used = ((static_cast<std::uint64_t>(last_) >> shift_) - aligned_) + 1;
    for (std::size_t b = 0; b <= used; ++b) {  // histogram_[used] is 0
        const Coord value = boundary(b);
        if (left > 0 && left < count_ && value > low_) {
            const std::size_t miss = left * 2 > count_ ? left * 2 - count_ : count_ - left * 2;
            const bool balanced = miss * 10 <= count_;
            const auto round = static_cast<std::size_t>(__builtin_ctzll(value));
            const bool better =
                balanced ? (!found_balanced || round > best_round || (round == best_round && miss < best_miss))
                         : (!found_balanced && miss < best_miss);
            if (better) {
                value_ = value;
                best_miss = miss;
                best_round = round;
                found_balanced = found_balanced || balanced;
            }
        }
        if (left * 2 <= count_ && b < used) {
            median_bucket = b;
            median_below = left;
        }
        left += histogram_[b];
    }
    if (best_miss == count_) value_.reset();
    // A third on each side is good enough; so is a single coordinate, which no cut can divide.
    if (best_miss * 3 <= count_ || shift_ == 0) return true;
    below_ = median_below;
    const Coord bucket_first = boundary(median_bucket);
    from_ = std::max(from_, bucket_first);
    last_ = std::min(last_, static_cast<Coord>(bucket_first + ((Coord(1) << shift_) - 1)));
    if (from_ > last_) {
        value_.reset();
        return true;
    }
    start_round();
    return false;
}

template std::size_t longest_axis(const std::array<std::uint32_t, 3>&, const std::array<std::uint32_t, 3>&,
                                  const AxisShift&);
template std::size_t longest_axis(const std::array<std::uint64_t, 3>&, const std::array<std::uint64_t, 3>&,
                                  const AxisShift&);
template class CutSearch<std::uint32_t>;
template class CutSearch<std::uint64_t>;

}  // namespace pcm
