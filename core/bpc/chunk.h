// A chunk in memory, decoded: the points of one node.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/system/page_allocator.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

// Grid positions relative to the chunk's origin (the smallest coordinate of each axis), so they are never negative.
// Narrow (32 bits per axis) when the chunk's extent allows it; for LAS sources it always does.
struct ChunkPositions {
    Vec3i origin{0, 0, 0};
    bool wide = false;
    std::array<PageVector<std::uint32_t>, 3> narrow_xyz;  // when !wide
    std::array<PageVector<std::uint64_t>, 3> wide_xyz;    // when wide

    std::size_t size() const { return wide ? wide_xyz[0].size() : narrow_xyz[0].size(); }
    std::uint64_t relative(std::size_t point, std::size_t axis) const
    {
        return wide ? wide_xyz[axis][point] : narrow_xyz[axis][point];
    }
    // Exact: origin + relative fits in 64 bits by construction.
    std::int64_t grid(std::size_t point, std::size_t axis) const
    {
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(origin[axis]) + relative(point, axis));
    }
    Vec3i grid(std::size_t point) const { return {grid(point, 0), grid(point, 1), grid(point, 2)}; }
    std::size_t bytes() const { return size() * 3 * (wide ? 8u : 4u); }
};

// Columns that were not read are null. Immutable once shared; copies share the columns.
struct Chunk {
    std::uint32_t points = 0;
    std::shared_ptr<const ChunkPositions> positions;
    // Size code of each point, u8 (tree/point_size.h). Not an attribute: made by the builder of a tree, for
    // drawing.
    std::shared_ptr<const Column> sizes;
    std::vector<std::shared_ptr<const Column>> attributes;  // one slot per attribute of the schema

    std::size_t bytes() const;  // memory of the columns present
    ColumnSet columns() const;  // the columns present
};

// What the sizes' column looks like.
const Attribute& attribute_of_sizes();

// A chunk may have been written before the last attributes of `schema` were added to its cloud, and without sizes. Adds
// their slots, and columns of zeros for those in `asked`.
void add_missing_columns(Chunk& chunk, const Schema& schema, const ColumnSet& asked);

}  // namespace pcm
