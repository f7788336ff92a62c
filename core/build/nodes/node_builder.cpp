#include "pcm/build/nodes/node_builder.h"

#include "pcm/bpc/chunk_encoder.h"
#include "pcm/build/levels/morton_sort.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcm {
namespace {

// Copies `count` values of `size` bytes, one from each row at `order`, one after the other to `to`. Frequent sizes get
// a copy of a length that the compiler knows.
void gather(const std::byte* from, std::size_t row_bytes, const std::uint32_t* order, std::size_t count,
            std::size_t size, std::byte* to)
{
    const auto copy = [&](auto fixed) {
        for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * fixed, from + order[i] * row_bytes, fixed);
    };
    switch (size) {
        case 1:
            return copy(std::integral_constant<std::size_t, 1>());
        case 2:
            return copy(std::integral_constant<std::size_t, 2>());
        case 4:
            return copy(std::integral_constant<std::size_t, 4>());
        case 6:
            return copy(std::integral_constant<std::size_t, 6>());
        case 8:
            return copy(std::integral_constant<std::size_t, 8>());
        case 12:
            return copy(std::integral_constant<std::size_t, 12>());
        default:
            return copy(size);
    }
}

}  // namespace

LevelRange levels_that_fit(const std::vector<std::uint64_t>& histogram, std::size_t first, std::uint64_t most)
{
    LevelRange range{first, first};
    std::uint64_t points = 0;
    for (std::size_t level = first; level < histogram.size(); ++level) {
        points += histogram[level];
        if (points > most) break;
        range.last = level + 1;
    }
    return range;
}

template <class Coord>
double NodeBuilder<Coord>::spacing_after(const LevelRange& own) const
{
    // A node without levels of its own: as if there were a level before the first.
    return own.last > 0 ? options_.spacings[own.last - 1] : 2 * options_.spacings[0];
}

template <class Coord>
auto NodeBuilder<Coord>::build(const LeveledRows& points, const NodePath& path, const std::vector<LevelRange>& above,
                               Output& output) -> Region
{
    if (points.levels.size() > std::numeric_limits<std::uint32_t>::max())
        throw Error(ErrorCode::unsupported, {},
                    "more than 4294967295 points share one position or are too close to part");
    Indices own;
    own.reserve(points.levels.size());
    Region region = divide(points, above, &own);
    if (!own.empty()) region.draft = build_range(points, own, above.empty() ? 0 : above.back().last, path, output);
    return region;
}

template <class Coord>
auto NodeBuilder<Coord>::hand_up(const LeveledRows& points, const std::vector<LevelRange>& above) const -> Region
{
    return divide(points, above, nullptr);
}

// Points of the levels that nodes above take go up; `own` gets the others.
template <class Coord>
auto NodeBuilder<Coord>::divide(const LeveledRows& points, const std::vector<LevelRange>& above, Indices* own) const
    -> Region
{
    const std::size_t row_bytes = options_.layout.bytes;
    const std::size_t first = above.empty() ? 0 : above.back().last;
    std::vector<std::size_t> taker(first);  // the depth of the node that takes a level
    for (std::size_t depth = 0; depth < above.size(); ++depth)
        for (std::size_t level = above[depth].first; level < above[depth].last; ++level) taker[level] = depth;
    Region region;
    region.above.resize(above.size());
    for (std::size_t i = 0; i < points.levels.size(); ++i) {
        const std::uint8_t level = points.levels[i];
        if (level >= first) {
            if (own) own->push_back(static_cast<std::uint32_t>(i));
            continue;
        }
        LeveledRows& to = region.above[taker[level]];
        const std::byte* row = points.rows.data() + i * row_bytes;
        to.rows.insert(to.rows.end(), row, row + row_bytes);
        to.levels.push_back(level);
        to.sizes.push_back(points.sizes[i]);
    }
    return region;
}

template <class Coord>
auto NodeBuilder<Coord>::join(Region left, Region right) -> Region
{
    Region region;
    region.above = std::move(left.above);
    for (std::size_t depth = 0; depth < right.above.size(); ++depth) {
        LeveledRows &to = region.above[depth], &from = right.above[depth];
        to.rows.insert(to.rows.end(), from.rows.begin(), from.rows.end());
        to.levels.insert(to.levels.end(), from.levels.begin(), from.levels.end());
        to.sizes.insert(to.sizes.end(), from.sizes.begin(), from.sizes.end());
        from = LeveledRows();
    }
    return region;
}

// Cuts the points at `indices` in two: keeps there those on the left, and returns the others.
template <class Coord>
auto NodeBuilder<Coord>::cut(const LeveledRows& points, Indices& indices) const -> Indices
{
    const std::size_t row_bytes = options_.layout.bytes;
    const std::byte* rows = points.rows.data();
    Point<Coord> low = coordinates_of<Coord>(rows + indices[0] * row_bytes), last = low;
    for (const std::uint32_t i : indices) {
        const Point<Coord> p = coordinates_of<Coord>(rows + i * row_bytes);
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            last[a] = std::max(last[a], p[a]);
        }
    }
    const std::size_t axis = longest_axis(low, last, options_.lattice.finer);
    std::vector<Coord> along(indices.size());
    for (std::size_t n = 0; n < along.size(); ++n)
        std::memcpy(&along[n], rows + indices[n] * row_bytes + axis * sizeof(Coord), sizeof(Coord));
    const std::optional<Coord> value = choose_cut_of(along.data(), along.size(), low[axis], last[axis]);
    if (!value) {  // all points are in one place
        const auto half = indices.begin() + static_cast<std::ptrdiff_t>(indices.size() / 2);
        Indices high(half, indices.end());
        indices.erase(half, indices.end());
        return high;
    }
    Indices high(indices.size());
    std::size_t below = 0, above = 0;
    for (std::size_t n = 0; n < along.size(); ++n) {
        const std::uint32_t i = indices[n];
        const bool left = along[n] < *value;
        indices[below] = high[above] = i;
        below += left;
        above += !left;
    }
    indices.resize(below);
    high.resize(above);
    return high;
}

template <class Coord>
Draft* NodeBuilder<Coord>::build_range(const LeveledRows& points, Indices& indices, std::size_t first,
                                       const NodePath& path, Output& output)
{
    Draft* draft = drafts_.add(path);
    if (indices.size() <= options_.chunk_points || path.depth >= NodePath::max_depth) {
        emit(points, indices, *draft, output);
        return draft;
    }
    std::vector<std::uint64_t> histogram(options_.spacings.size(), 0);
    for (const std::uint32_t i : indices) ++histogram[points.levels[i]];
    const LevelRange own = levels_that_fit(histogram, first, options_.chunk_points);

    // Each index is written to both lists, and kept in one of them: which one cannot be predicted.
    Indices mine(indices.size()), rest(indices.size());
    std::size_t taken = 0, left = 0;
    for (const std::uint32_t i : indices) {
        const bool is_own = points.levels[i] < own.last;
        mine[taken] = i;
        rest[left] = i;
        taken += is_own;
        left += !is_own;
    }
    mine.resize(taken);
    mine.shrink_to_fit();
    rest.resize(left);
    if (rest.size() <= options_.chunk_points) {
        draft->children[0] = build_range(points, rest, own.last, path.child(0), output);
    } else {
        Indices().swap(indices);
        Indices high = cut(points, rest);
        draft->children[0] = build_range(points, rest, own.last, path.child(0), output);
        draft->children[1] = build_range(points, high, own.last, path.child(1), output);
    }
    draft->spacing = spacing_after(own);
    emit(points, mine, *draft, output);
    return draft;
}

template <class Coord>
auto NodeBuilder<Coord>::merge(Region left, Region right, const NodePath& path, const LevelRange& own, Output& output)
    -> Region
{
    const std::array<Draft*, 2> children{left.draft, right.draft};
    Region region = join(std::move(left), std::move(right));
    const LeveledRows mine = std::move(region.above.back());
    region.above.pop_back();
    if (mine.levels.empty() && !children[0] && !children[1]) return region;

    const Indices indices =
        morton_order<Coord>(mine.rows.data(), mine.levels.size(), options_.layout, options_.lattice.finer);
    region.draft = drafts_.add(path);
    region.draft->children = children;
    if (children[0] || children[1]) region.draft->spacing = spacing_after(own);
    emit(mine, indices, *region.draft, output);
    return region;
}

// The indices by level, each level in the order that they have. Sets the draft's levels.
template <class Coord>
auto NodeBuilder<Coord>::by_level(const LeveledRows& points, const Indices& indices, Draft& draft) -> Indices
{
    std::array<std::uint32_t, 257> start{};
    for (const std::uint32_t i : indices) ++start[points.levels[i] + 1u];
    std::size_t low_level = 0, high_level = 255;
    while (start[low_level + 1] == 0) ++low_level;
    while (start[high_level + 1] == 0) --high_level;
    draft.first_level = static_cast<std::uint16_t>(low_level);
    draft.level_points.assign(start.begin() + static_cast<std::ptrdiff_t>(low_level + 1),
                              start.begin() + static_cast<std::ptrdiff_t>(high_level + 2));
    for (std::size_t level = 0; level < 256; ++level) start[level + 1] += start[level];
    Indices order(indices.size());
    for (const std::uint32_t i : indices) order[start[points.levels[i]]++] = i;
    return order;
}

// The positions of the points at `order`, relative to the corner of their box. Sets the draft's box.
template <class Coord>
std::shared_ptr<ChunkPositions> NodeBuilder<Coord>::positions_of(const LeveledRows& points, const Indices& order,
                                                                 Draft& draft) const
{
    const std::size_t row_bytes = options_.layout.bytes;
    const auto point = [&](std::uint32_t i) { return coordinates_of<Coord>(points.rows.data() + i * row_bytes); };
    Point<Coord> low = point(order[0]), high = low;
    for (const std::uint32_t i : order) {
        const Point<Coord> p = point(i);
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }
    for (std::size_t a = 0; a < 3; ++a) {
        draft.box.min[a] = to_grid<Coord>(low[a]);
        draft.box.max[a] = to_grid<Coord>(high[a]);
    }

    auto positions = std::make_shared<ChunkPositions>();
    positions->origin = draft.box.min;
    for (std::size_t a = 0; a < 3; ++a)
        if (static_cast<std::uint64_t>(high[a] - low[a]) > std::numeric_limits<std::uint32_t>::max())
            positions->wide = true;
    const auto fill = [&](auto& axes) {
        using Word = typename std::decay_t<decltype(axes[0])>::value_type;
        for (auto& axis : axes) axis.resize(order.size());
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Point<Coord> p = point(order[i]);
            for (std::size_t a = 0; a < 3; ++a) axes[a][i] = static_cast<Word>(p[a] - low[a]);
        }
    };
    if (positions->wide)
        fill(positions->wide_xyz);
    else
        fill(positions->narrow_xyz);
    return positions;
}

template <class Coord>
std::vector<std::shared_ptr<Column>> NodeBuilder<Coord>::columns_of(const LeveledRows& points,
                                                                    const Indices& order) const
{
    std::vector<std::shared_ptr<Column>> columns;
    for (const Attribute& attribute : options_.schema) {
        columns.push_back(std::make_shared<Column>(attribute));
        columns.back()->resize(order.size());
    }
    // Few rows at a time, which stay in the cache until all their columns are taken.
    constexpr std::size_t few = 512;
    for (std::size_t first = 0; first < order.size(); first += few) {
        const std::size_t count = std::min(few, order.size() - first);
        for (std::size_t k = 0; k < columns.size(); ++k) {
            const std::size_t size = options_.layout.sizes[k];
            gather(points.rows.data() + options_.layout.offsets[k], options_.layout.bytes, order.data() + first, count,
                   size, columns[k]->data() + first * size);
        }
    }
    return columns;
}

template <class Coord>
void NodeBuilder<Coord>::emit(const LeveledRows& points, const Indices& indices, Draft& draft, Output& output) const
{
    if (indices.empty()) return;
    const Indices order = by_level(points, indices, draft);
    draft.points = static_cast<std::uint32_t>(order.size());
    Chunk chunk;
    chunk.points = draft.points;
    chunk.positions = positions_of(points, order, draft);
    for (auto& column : columns_of(points, order)) chunk.attributes.push_back(std::move(column));
    const auto sizes = std::make_shared<Column>(attribute_of_sizes());
    sizes->resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) sizes->as<std::uint8_t>()[i] = points.sizes[order[i]];
    chunk.sizes = sizes;
    ChunkIdentity identity;
    identity.path = draft.path;
    identity.part = options_.part;
    identity.generation = options_.generation;
    identity.first_level = draft.first_level;
    identity.level_points = draft.level_points;
    identity.spacing = draft.spacing;
    const std::vector<std::byte> bytes = encode_chunk(chunk, options_.schema, options_.grid, identity);
    output.pieces.push_back({&draft, output.bytes.size(), bytes.size()});
    draft.extent.bytes = bytes.size();
    std::memcpy(&draft.extent.header_bytes, bytes.data() + 24, 4);
    output.bytes.insert(output.bytes.end(), bytes.begin(), bytes.end());
}

template class NodeBuilder<std::uint32_t>;
template class NodeBuilder<std::uint64_t>;

}  // namespace pcm
