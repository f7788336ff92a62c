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

// Grid positions relative to the chunk's origin (the smallest coordinate on each axis), so they are never negative.
// Narrow (32 bits an axis) whenever the chunk's extent allows, which for LAS sources is always.
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

// Columns that were not asked for are null. Immutable once shared; copies share the columns.
struct Chunk {
    std::uint32_t points = 0;
    std::shared_ptr<const ChunkPositions> positions;
    std::vector<std::shared_ptr<const Column>> attributes;  // one slot an attribute of the schema

    std::size_t bytes() const;  // of the columns present
    ColumnSet columns() const;  // which are present
};

// Gives a chunk that was written before its cloud got the last attributes of `schema` a slot for each, and zeros in
// those of them that are asked for.
void add_missing_columns(Chunk& chunk, const Schema& schema, const ColumnSet& asked);

}  // namespace pcm
