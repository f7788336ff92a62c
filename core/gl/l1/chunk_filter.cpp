#include "pcm/gl/l1/chunk_filter.h"

#include "pcm/system/error.h"

#include <numeric>

namespace pcm {
namespace {

template <class T>
void keep(std::array<PageVector<T>, 3>& to, const std::array<PageVector<T>, 3>& from,
          const std::vector<std::uint32_t>& kept)
{
    for (std::size_t axis = 0; axis < 3 && !from[axis].empty(); ++axis) {
        to[axis].resize(kept.size());
        for (std::size_t i = 0; i < kept.size(); ++i) to[axis][i] = from[axis][kept[i]];
    }
}

std::shared_ptr<const Column> kept_of(const Column& column, const std::vector<std::uint32_t>& kept)
{
    auto rest = std::make_shared<Column>(column);
    keep_points(*rest, kept);
    return rest;
}

}  // namespace

ChunkFilter::ChunkFilter(const std::vector<Condition>& where, const std::vector<Clip>& clips, const Schema& schema)
{
    Selection selection;
    selection.clips = clips;
    for (const Condition& condition : where) {
        Selection one;
        one.where = {condition};
        try {
            Selector test(one, schema);
            selection.where.push_back(condition);
        } catch (const Error& error) {
            if (!notice_.empty()) notice_ += "; ";
            notice_ += "the filter '" + condition.text + "' is not applied: " + error.what();
        }
    }
    if (selection.where.empty() && clips.empty()) return;
    selector_.emplace(selection, schema);
    for (const std::size_t attribute : selector_->tested()) tested_.attributes.set(attribute);
}

std::optional<std::vector<std::uint32_t>> ChunkFilter::shown(const Chunk& chunk, const Grid& grid) const
{
    if (!selector_) return std::nullopt;
    std::vector<std::uint32_t> kept(chunk.points);
    std::iota(kept.begin(), kept.end(), 0u);
    std::vector<const Column*> columns;
    for (const auto& column : chunk.attributes) columns.push_back(column.get());
    selector_->narrow(
        columns, [&](std::size_t i) { return grid.to_source(chunk.positions->grid(i)); }, kept);
    if (kept.size() == chunk.points) return std::nullopt;
    return kept;
}

Chunk ChunkFilter::take(const Chunk& chunk, const std::vector<std::uint32_t>& kept, const ColumnSet& needed)
{
    Chunk rest;
    rest.points = static_cast<std::uint32_t>(kept.size());
    auto positions = std::make_shared<ChunkPositions>();
    positions->origin = chunk.positions->origin;
    positions->wide = chunk.positions->wide;
    keep(positions->narrow_xyz, chunk.positions->narrow_xyz, kept);
    keep(positions->wide_xyz, chunk.positions->wide_xyz, kept);
    rest.positions = std::move(positions);
    if (needed.sizes && chunk.sizes) rest.sizes = kept_of(*chunk.sizes, kept);
    rest.attributes.resize(chunk.attributes.size());
    for (std::size_t k = 0; k < chunk.attributes.size(); ++k) {
        if (!needed.attributes[k] || !chunk.attributes[k]) continue;
        rest.attributes[k] = kept_of(*chunk.attributes[k], kept);
    }
    return rest;
}

}  // namespace pcm
