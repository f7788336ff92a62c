#include "tree/node_builder.h"

#include "cloud/error.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace pcm {
namespace {

// Puts two zero bits between the low 21 bits of v.
std::uint64_t spread(std::uint64_t v)
{
    std::uint64_t x = v & 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffULL;
    x = (x | x << 16) & 0x1f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    x = (x | x << 2) & 0x1249249249249249ULL;
    return x;
}

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

// Codes in units of 2^unit_bits grid steps of the coarsest axis, relative to a base that all cells up to the size of the
// set are aligned to.
template <class Coord>
struct NodeBuilder<Coord>::Order {
    std::vector<CodeIndex> items;
    std::array<Coord, 3> base;
    int unit_bits = 0;
};

template <class Coord>
auto NodeBuilder<Coord>::morton_order(const std::vector<Key>& keys, const std::vector<const std::byte*>& row_of) const -> Order
{
    Order order;
    std::array<Coord, 3> low = keys[0].c, high = keys[0].c;
    for (const Key& key : keys)
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], key.c[a]);
            high[a] = std::max(high[a], key.c[a]);
        }
    int extent_bits = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto extent = static_cast<std::uint64_t>(high[a] - low[a]) >> options_.finer[a];
        extent_bits = std::max(extent_bits, extent ? 64 - __builtin_clzll(extent) : 0);
    }
    for (std::size_t a = 0; a < 3; ++a) {
        const int bits = extent_bits + options_.finer[a];
        order.base[a] = bits >= static_cast<int>(sizeof(Coord) * 8) ? Coord(0) : static_cast<Coord>(low[a] >> bits << bits);
    }
    order.unit_bits = std::max(0, extent_bits + 1 - 21);
    order.items.resize(keys.size());
    std::array<int, 3> shift;
    for (std::size_t a = 0; a < 3; ++a) shift[a] = std::min(63, order.unit_bits + options_.finer[a]);
    for (std::size_t i = 0; i < keys.size(); ++i) {
        std::uint64_t code = 0;
        for (std::size_t a = 0; a < 3; ++a)
            code |= spread(static_cast<std::uint64_t>(keys[i].c[a] - order.base[a]) >> shift[a]) << a;
        order.items[i] = {code, static_cast<std::uint32_t>(i)};
    }
    radix_sort(order.items);
    // Points of one code in an order of their own: by coordinates, then by their attributes' bytes.
    const std::size_t row_bytes = options_.layout.bytes;
    for (std::size_t from = 0; from < order.items.size();) {
        std::size_t to = from + 1;
        while (to < order.items.size() && order.items[to].code == order.items[from].code) ++to;
        if (to - from > 1)
            std::sort(order.items.begin() + static_cast<std::ptrdiff_t>(from),
                      order.items.begin() + static_cast<std::ptrdiff_t>(to), [&](const CodeIndex& p, const CodeIndex& q) {
                          if (keys[p.index].c != keys[q.index].c) return keys[p.index].c < keys[q.index].c;
                          return std::memcmp(row_of[p.index], row_of[q.index], row_bytes) < 0;
                      });
        from = to;
    }
    return order;
}

template <class Coord>
auto NodeBuilder<Coord>::build(std::vector<std::byte> bytes, const NodePath& path, Output& output) -> Region
{
    const std::size_t row_bytes = options_.layout.bytes;
    const std::size_t count = bytes.size() / row_bytes;
    if (count > std::numeric_limits<std::uint32_t>::max())
        throw Error(ErrorCode::unsupported, {}, "more than 4294967295 points share one position or are too close to part");
    const Rows rows = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
    std::vector<Key> keys(count);
    for (std::size_t i = 0; i < count; ++i)
        keys[i] = {coordinates_of<Coord>(rows->data() + i * row_bytes), static_cast<std::uint32_t>(i)};
    return build_range(keys.data(), count, rows, path, output);
}

template <class Coord>
auto NodeBuilder<Coord>::build_range(Key* keys, std::size_t count, const Rows& rows, const NodePath& path,
                                     Output& output) -> Region
{
    if (count > options_.chunk_points && path.depth < NodePath::max_depth) {
        const auto cut =
            choose_cut<Coord>(count, options_.finer, [&](std::size_t i, std::size_t axis) { return keys[i].c[axis]; });
        if (cut) {
            Key* middle =
                std::partition(keys, keys + count, [&](const Key& key) { return key.c[cut->axis] < cut->value; });
            const auto left = static_cast<std::size_t>(middle - keys);
            Region low = build_range(keys, left, rows, path.child(0), output);
            Region high = build_range(middle, count - left, rows, path.child(1), output);
            return merge(std::move(low), std::move(high), path, output);
        }
    }
    Region region;
    region.candidates.assign(keys, keys + count);
    region.rows = rows;
    region.draft = drafts_.add(path);
    return region;
}

template <class Coord>
auto NodeBuilder<Coord>::merge(Region left, Region right, const NodePath& path, Output& output) -> Region
{
    const std::size_t row_bytes = options_.layout.bytes;
    const std::size_t from_left = left.candidates.size();
    std::vector<Key> keys = left.candidates;
    keys.insert(keys.end(), right.candidates.begin(), right.candidates.end());
    std::vector<const std::byte*> row_of(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i)
        row_of[i] = (i < from_left ? left : right).rows->data() + keys[i].row * row_bytes;
    const Order order = morton_order(keys, row_of);
    const std::vector<CodeIndex>& items = order.items;

    // How many cells the lattice has at each level: neighbours in Morton order part at the level of their highest
    // differing bit.
    std::array<std::size_t, 65> parted{};
    for (std::size_t i = 1; i < items.size(); ++i)
        if (const std::uint64_t differ = items[i].code ^ items[i - 1].code)
            ++parted[static_cast<std::size_t>(63 - __builtin_clzll(differ))];
    const std::size_t share = options_.chunk_points / 2;
    const int finest_allowed = std::max(left.lattice_level, right.lattice_level);
    int dropped = 63;
    std::size_t cells = 1;
    while (dropped > 0 && cells + parted[static_cast<std::size_t>(dropped - 1)] <= share &&
           3 * order.unit_bits + dropped - 1 >= finest_allowed) {
        --dropped;
        cells += parted[static_cast<std::size_t>(dropped)];
    }

    Region region;
    region.lattice_level = 3 * order.unit_bits + dropped;
    std::vector<std::uint8_t> chosen(keys.size(), 0);
    // Bits of the cell's extent along each axis: x gives its lowest bit up first.
    std::array<int, 3> cell_bits;
    for (int a = 0; a < 3; ++a)
        cell_bits[static_cast<std::size_t>(a)] =
            std::min(62, order.unit_bits + (dropped + 2 - a) / 3 + options_.finer[static_cast<std::size_t>(a)]);
    const auto from_centre = [&](const Key& key) {
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const auto inside = static_cast<std::uint64_t>(key.c[a] - order.base[a]) &
                                ((std::uint64_t(1) << cell_bits[a]) - 1);
            const double d = std::ldexp(static_cast<double>(inside) + 0.5, -options_.finer[a]) -
                             std::ldexp(0.5, cell_bits[a] - options_.finer[a]);
            sum += d * d;
        }
        return sum;
    };
    for (std::size_t from = 0; from < items.size();) {
        std::size_t best = from;
        std::size_t to = from + 1;
        const std::uint64_t cell = items[from].code >> dropped;
        double nearest = -1;
        for (; to < items.size() && items[to].code >> dropped == cell; ++to) {
            if (nearest < 0) nearest = from_centre(keys[items[from].index]);
            const double d = from_centre(keys[items[to].index]);
            if (d < nearest) {
                nearest = d;
                best = to;
            }
        }
        chosen[items[best].index] = 1;
        from = to;
    }

    std::vector<Key> rest[2];
    std::vector<std::uint8_t> side_of_chosen;
    for (const CodeIndex& item : items) {
        const unsigned side = item.index < from_left ? 0 : 1;
        if (chosen[item.index]) {
            region.candidates.push_back(keys[item.index]);
            side_of_chosen.push_back(static_cast<std::uint8_t>(side));
        } else {
            rest[side].push_back(keys[item.index]);
        }
    }
    emit(rest[0], left.rows->data(), *left.draft, output);
    emit(rest[1], right.rows->data(), *right.draft, output);

    if (left.rows == right.rows) {
        region.rows = left.rows;
    } else {
        auto rows = std::make_shared<std::vector<std::byte>>(region.candidates.size() * row_bytes);
        for (std::size_t i = 0; i < region.candidates.size(); ++i) {
            const Region& from = side_of_chosen[i] ? right : left;
            std::memcpy(rows->data() + i * row_bytes, from.rows->data() + region.candidates[i].row * row_bytes, row_bytes);
            region.candidates[i].row = static_cast<std::uint32_t>(i);
        }
        region.rows = std::move(rows);
    }
    region.draft = drafts_.add(path);
    Draft& draft = *region.draft;
    draft.children = {left.draft, right.draft};
    // A cell's extent, the geometric mean of the three axes, in source units.
    double volume_root = 1;
    for (std::size_t a = 0; a < 3; ++a) volume_root *= std::cbrt(options_.grid.scale[a]);
    const int finer = options_.finer[0] + options_.finer[1] + options_.finer[2];
    draft.spacing = volume_root * std::exp2((region.lattice_level + finer) / 3.0);
    return region;
}

template <class Coord>
void NodeBuilder<Coord>::finish(Region root, Output& output)
{
    std::vector<const std::byte*> row_of(root.candidates.size());
    for (std::size_t i = 0; i < row_of.size(); ++i)
        row_of[i] = root.rows->data() + root.candidates[i].row * options_.layout.bytes;
    const Order order = morton_order(root.candidates, row_of);
    std::vector<Key> keys;
    keys.reserve(order.items.size());
    for (const CodeIndex& item : order.items) keys.push_back(root.candidates[item.index]);
    emit(keys, root.rows->data(), *root.draft, output);
}

template <class Coord>
void NodeBuilder<Coord>::compact(Region& region) const
{
    const std::size_t row_bytes = options_.layout.bytes;
    auto rows = std::make_shared<std::vector<std::byte>>(region.candidates.size() * row_bytes);
    for (std::size_t i = 0; i < region.candidates.size(); ++i) {
        std::memcpy(rows->data() + i * row_bytes, region.rows->data() + region.candidates[i].row * row_bytes, row_bytes);
        region.candidates[i].row = static_cast<std::uint32_t>(i);
    }
    region.rows = std::move(rows);
}

template <class Coord>
void NodeBuilder<Coord>::emit(const std::vector<Key>& keys, const std::byte* rows, Draft& draft, Output& output)
{
    if (keys.empty()) return;
    std::array<Coord, 3> low = keys[0].c, high = keys[0].c;
    for (const Key& key : keys)
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], key.c[a]);
            high[a] = std::max(high[a], key.c[a]);
        }
    for (std::size_t a = 0; a < 3; ++a) {
        draft.box.min[a] = to_grid<Coord>(low[a]);
        draft.box.max[a] = to_grid<Coord>(high[a]);
    }
    draft.points = static_cast<std::uint32_t>(keys.size());

    auto positions = std::make_shared<ChunkPositions>();
    positions->origin = draft.box.min;
    for (std::size_t a = 0; a < 3; ++a)
        if (static_cast<std::uint64_t>(high[a] - low[a]) > std::numeric_limits<std::uint32_t>::max()) positions->wide = true;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto fill = [&](auto& axis) {
            axis.resize(keys.size());
            for (std::size_t i = 0; i < keys.size(); ++i)
                axis[i] = static_cast<typename std::decay_t<decltype(axis)>::value_type>(keys[i].c[a] - low[a]);
        };
        if (positions->wide)
            fill(positions->wide_xyz[a]);
        else
            fill(positions->narrow_xyz[a]);
    }
    Chunk chunk;
    chunk.points = draft.points;
    chunk.positions = std::move(positions);
    const std::size_t row_bytes = options_.layout.bytes;
    for (std::size_t k = 0; k < options_.schema.size(); ++k) {
        auto column = std::make_shared<Column>(options_.schema[k]);
        column->resize(keys.size());
        std::byte* to = column->data();
        const std::byte* from = rows + options_.layout.offsets[k];
        const std::size_t size = options_.layout.sizes[k];
        const auto gather = [&](auto fixed) {
            for (std::size_t i = 0; i < keys.size(); ++i)
                std::memcpy(to + i * fixed, from + keys[i].row * row_bytes, fixed);
        };
        switch (size) {
        case 1: gather(std::integral_constant<std::size_t, 1>()); break;
        case 2: gather(std::integral_constant<std::size_t, 2>()); break;
        case 4: gather(std::integral_constant<std::size_t, 4>()); break;
        case 6: gather(std::integral_constant<std::size_t, 6>()); break;
        case 8: gather(std::integral_constant<std::size_t, 8>()); break;
        case 12: gather(std::integral_constant<std::size_t, 12>()); break;
        default: gather(size);
        }
        chunk.attributes.push_back(std::move(column));
    }
    const std::vector<std::byte> bytes = encode_chunk(chunk, options_.schema, options_.grid, draft.path);
    output.pieces.push_back({&draft, output.bytes.size(), bytes.size()});
    draft.extent.bytes = bytes.size();
    std::memcpy(&draft.extent.header_bytes, bytes.data() + 24, 4);
    output.bytes.insert(output.bytes.end(), bytes.begin(), bytes.end());
}

template class NodeBuilder<std::uint32_t>;
template class NodeBuilder<std::uint64_t>;

}  // namespace pcm
