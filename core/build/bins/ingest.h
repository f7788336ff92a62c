// The input of a build: points sampled ahead, batches as rows, doubles on a grid.
#pragma once

#include "pcm/build/bins/row.h"
#include "pcm/io/reader.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// Grid coordinates of `count` points spread evenly over a cloud, in its order. Only for a reader that is seekable and
// gridded and knows its number of points; the next read() starts at the beginning again.
std::vector<Vec3i> sample_evenly(PointReader& cloud, std::size_t count);

// Copies the attributes of batch.size points to their places in as many rows; coordinates are left unchanged.
void put_attributes(const PointBatch& batch, const RowLayout& layout, std::byte* rows);

// The nearest grid position. Throws nothing; |value| must be below the magnitude that the grid was made for.
std::int64_t to_grid_position(double value, double scale, double offset);

}  // namespace pcm
