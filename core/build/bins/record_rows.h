// Records of a file as rows, without columns between them.
#pragma once

#include "pcm/build/bins/observed.h"
#include "pcm/build/bins/row.h"
#include "pcm/io/record_batch.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// The coordinates of point i, as in rows.
std::array<std::uint32_t, 3> coordinates_of(const RecordBatch& batch, std::size_t i);

// Replaces `rows` by those of the batch, of a cloud with narrow coordinates, and adds to their statistics.
void put_record_rows(const RecordBatch& batch, const RowLayout& layout, std::vector<std::byte>& rows,
                     Observed& observed);

}  // namespace pcm
