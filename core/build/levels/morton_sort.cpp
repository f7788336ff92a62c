#include "pcm/build/levels/morton_sort.h"

#include "pcm/cloud/morton.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace pcm {
namespace {

struct CodeIndex {
    std::uint64_t code;
    std::uint32_t index;
};

// Least significant digit first, 11 bits a pass, only the bits that differ.
void radix_sort(std::vector<CodeIndex>& items)
{
    std::uint64_t any = 0;
    for (const CodeIndex& item : items) any |= item.code ^ items[0].code;
    std::vector<CodeIndex> other(items.size());
    std::array<std::uint32_t, 2049> start;
    for (int shift = 0; shift < 64 && any >> shift; shift += 11) {
        if (!(any >> shift & 2047)) continue;
        start.fill(0);
        for (const CodeIndex& item : items) ++start[(item.code >> shift & 2047) + 1];
        for (std::size_t d = 0; d < 2048; ++d) start[d + 1] += start[d];
        for (const CodeIndex& item : items) other[start[item.code >> shift & 2047]++] = item;
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

    const int dropped = std::max(0, extent - (morton_axis_bits - 1));
    const int kept = extent - dropped;  // bits of an axis below the border bits
    std::vector<CodeIndex> items(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Point<Coord> p = point(i);
        std::uint64_t code = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::uint64_t c = ((static_cast<std::uint64_t>(p[a]) >> finer[a]) - base[a]) >> dropped;
            code |= spread_bits(c & ((std::uint64_t(1) << kept) - 1)) << a;
            code |= (c >> kept & 1) << (3 * kept + rank[a]);
        }
        items[i] = {code, static_cast<std::uint32_t>(i)};
    }
    radix_sort(items);
    for (std::size_t from = 0; from < count;) {
        std::size_t to = from + 1;
        while (to < count && items[to].code == items[from].code) ++to;
        if (to - from > 1)
            std::sort(items.begin() + static_cast<std::ptrdiff_t>(from),
                      items.begin() + static_cast<std::ptrdiff_t>(to), [&](const CodeIndex& p, const CodeIndex& q) {
                          const Point<Coord> a = point(p.index), b = point(q.index);
                          if (a != b) return morton_before(a, b, finer);
                          return std::memcmp(rows + p.index * layout.bytes, rows + q.index * layout.bytes,
                                             layout.bytes) < 0;
                      });
        from = to;
    }
    for (std::size_t i = 0; i < count; ++i) order[i] = items[i].index;
    return order;
}

template std::vector<std::uint32_t> morton_order<std::uint32_t>(const std::byte*, std::size_t, const RowLayout&,
                                                                const AxisShift&);
template std::vector<std::uint32_t> morton_order<std::uint64_t>(const std::byte*, std::size_t, const RowLayout&,
                                                                const AxisShift&);

}  // namespace pcm
