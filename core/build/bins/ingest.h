// The input of a build: points sampled ahead, batches as rows, doubles on a grid.
#pragma once

#include "pcm/build/bins/observed.h"
#include "pcm/build/bins/row.h"
#include "pcm/io/reader.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// Coordinates, as in rows, of points spread evenly over a cloud, in its order: all or 1/2, 1/4, ... 1/1024 of them,
// more than 32768 where there are. Only for a reader that is seekable and gridded and knows its number of points; the
// next read() starts at the beginning again.
std::vector<std::array<std::uint32_t, 3>> sample_evenly(PointReader& cloud);
// Share `share` of `shares` of this sample; the shares one after the other are the sample.
std::vector<std::array<std::uint32_t, 3>> sample_evenly(PointReader& cloud, unsigned share, unsigned shares);

// The coordinates of a point of a gridded batch, as in rows.
std::array<std::uint32_t, 3> coordinates_of(const PointBatch& batch, std::size_t i);

// Copies the attributes of batch.size points to their places in as many rows; coordinates are left unchanged.
void put_attributes(const PointBatch& batch, const RowLayout& layout, std::byte* rows);

// Replaces `rows` by those of a gridded batch, of a cloud with narrow coordinates, and adds to their statistics.
void put_gridded_rows(const PointBatch& batch, const RowLayout& layout, std::vector<std::byte>& rows,
                      Observed& observed);

// The nearest grid position. Throws nothing; |value| must be below the magnitude that the grid was made for.
std::int64_t to_grid_position(double value, double scale, double offset);

}  // namespace pcm
