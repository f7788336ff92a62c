// Clouds whose positions are doubles: rows of them, the grid that they get, and their rows on it.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/bins/row.h"
#include "pcm/io/pipe/far_points.h"
#include "pcm/io/reader.h"
#include "pcm/tree/source_rounding.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

// Makes rows of a wide layout whose positions are doubles. One thread.
class DoubleRows {
public:
    // `counts_decimals`: finds the digits of the coordinates.
    DoubleRows(const RowLayout& layout, bool counts_decimals) : layout_(layout), counts_decimals_(counts_decimals) {}

    // Replaces `rows` by those of the points with finite positions, and returns their number.
    std::size_t put(const PointBatch& batch, std::vector<std::byte>& rows);
    std::array<DecimalCount, 3>& decimals() { return decimals_; }

private:
    const RowLayout layout_;
    const bool counts_decimals_;
    std::array<DecimalCount, 3> decimals_;
};

std::string note_of_skipped(std::uint64_t points);  // points without a finite position

// Whether the digits of the coordinates say which numbers the source had.
bool counts_decimals(const FileInfo& info);

// Chooses the grid of a cloud of doubles, when all positions were watched. Doubles that come from integers keep the
// grid of those integers; others get a power of two per axis, the finest that holds the largest coordinate. True when
// all positions are narrow on it. Throws what check_tree_grid() and check_tree_positions() throw.
bool choose_grid(const FileInfo& info, const FarPoints& positions, Ingested& found);

// Puts rows of doubles on a grid. Any thread.
template <class Coord>
class GridRows {
public:
    GridRows(const Grid& grid, const DecimalPlaces& decimals) : grid_(grid), rounding_(decimals) {}

    std::array<Coord, 3> on_grid(const Vec3d& p) const;
    // The row becomes one of Coord, in place, `row_bytes` long: with narrow coordinates it begins later. Adds it to the
    // statistics; `rounded` becomes true where the grid does not hold the position. Returns the row's beginning.
    std::byte* convert(std::byte* row, std::size_t row_bytes, Observed& seen, bool& rounded) const;

private:
    const Grid grid_;
    const SourceRounding rounding_;
};

extern template class GridRows<std::uint32_t>;
extern template class GridRows<std::uint64_t>;

}  // namespace pcm
