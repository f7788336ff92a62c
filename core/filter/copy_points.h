// Some values of a column, copied one after the other.
#pragma once

#include "pcm/cloud/point_batch.h"

#include <cstddef>
#include <cstdint>

namespace pcm {

// Copies the values of `count` points with these numbers to `to`; `points` null: of the first `count`.
void copy_points(const Column& from, const std::uint32_t* points, std::size_t count, std::byte* to);

}  // namespace pcm
