#include "pcm/build/levels/morton_sort.h"

#include "pcm/cloud/morton.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace pcm {
namespace {

// By the bits from `low` on, least significant digit first, 11 bits a pass, only the bits that differ.
void radix_sort(std::vector<std::uint64_t>& items, int low)
{
    constexpr int digit = 11;
    constexpr std::uint64_t mask = (1u << digit) - 1;
    std::uint64_t any = 0;
    for (const std::uint64_t item : items) any |= item ^ items[0];
    std::vector<std::uint64_t> other(items.size());
    std::array<std::uint32_t, mask + 2> start;
    for (int shift = low; shift < 64 && any >> shift; shift += digit) {
        if (!(any >> shift & mask)) continue;
        start.fill(0);
        for (const std::uint64_t item : items) ++start[(item >> shift & mask) + 1];
        for (std::size_t d = 0; d <= mask; ++d) start[d + 1] += start[d];
        for (const std::uint64_t item : items) other[start[item >> shift & mask]++] = item;
        items.swap(other);
    }
}

}  // namespace

template <class Coord>
std::vector<std::uint32_t> morton_order(const std::byte* rows, std::size_t count, const RowLayout& layout,
                                        const AxisShift& finer)
{
    const auto point = [&](std::size_t i) { return coordinates_of<Coord>(rows + i * layout.bytes); };
    std::vector<std::uint32_t> order(count);
    if (count == 0) return order;
    Point<Coord> low = point(0), high = low;
    for (std::size_t i = 1; i < count; ++i) {
        const Point<Coord> p = point(i);
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }

    // Coordinates relative to a base: `extent` low bits, and above them one bit that says on which side of a large
    // cell's border the point lies. These three bits are in the order of their true places, which may be far above.
    Lattice lattice;
    lattice.finer = finer;
    const int extent = lattice.size_of_box<Coord>(low, high);
    std::array<std::uint64_t, 3> base;
    std::array<int, 3> place;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::uint64_t lowest = static_cast<std::uint64_t>(low[a]) >> finer[a];
        base[a] = extent >= 64 ? 0 : lowest >> extent << extent;
        const std::uint64_t differ =
            (static_cast<std::uint64_t>(low[a]) ^ static_cast<std::uint64_t>(high[a])) >> finer[a];
        place[a] = differ ? 63 - __builtin_clzll(differ) : -1;
    }
    std::array<std::size_t, 3> axes{0, 1, 2};
    std::stable_sort(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) { return place[a] < place[b]; });
    std::array<int, 3> rank{};
    for (std::size_t r = 0; r < 3; ++r) rank[axes[r]] = static_cast<int>(r);

    // An item is a code and, in its low bits, the point's index. A code has the four digits that are sorted by, if it
    // has room: few points are left that it does not part.
    int index_bits = 1;
    while ((count - 1) >> index_bits) ++index_bits;
    const int kept = std::min({extent, 13, (64 - 3 - index_bits) / 3});  // bits of an axis below the border bits
    const int dropped = extent - kept;
    std::vector<std::uint64_t> items(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Point<Coord> p = point(i);
        std::uint64_t code = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::uint64_t c = ((static_cast<std::uint64_t>(p[a]) >> finer[a]) - base[a]) >> dropped;
            code |= spread_bits(c & ((std::uint64_t(1) << kept) - 1)) << a;
            code |= (c >> kept & 1) << (3 * kept + rank[a]);
        }
        items[i] = code << index_bits | i;
    }
    radix_sort(items, index_bits);
    const std::uint64_t index = (std::uint64_t(1) << index_bits) - 1;
    for (std::size_t from = 0; from < count;) {
        std::size_t to = from + 1;
        while (to < count && items[to] >> index_bits == items[from] >> index_bits) ++to;
        if (to - from > 1)
            std::sort(items.begin() + static_cast<std::ptrdiff_t>(from),
                      items.begin() + static_cast<std::ptrdiff_t>(to), [&](std::uint64_t p, std::uint64_t q) {
                          const Point<Coord> a = point(p & index), b = point(q & index);
                          if (a != b) return morton_before(a, b, finer);
                          return std::memcmp(rows + (p & index) * layout.bytes, rows + (q & index) * layout.bytes,
                                             layout.bytes) < 0;
                      });
        from = to;
    }
    for (std::size_t i = 0; i < count; ++i) order[i] = static_cast<std::uint32_t>(items[i] & index);
    return order;
}

template std::vector<std::uint32_t> morton_order<std::uint32_t>(const std::byte*, std::size_t, const RowLayout&,
                                                                const AxisShift&);
template std::vector<std::uint32_t> morton_order<std::uint64_t>(const std::byte*, std::size_t, const RowLayout&,
                                                                const AxisShift&);

}  // namespace pcm
