// Rows of a bin in Morton order.
#pragma once

#include "pcm/build/bins/row.h"
#include "pcm/build/levels/lattice.h"

#include <cstdint>
#include <vector>

namespace pcm {

// The Morton order of `count` rows (lattice.h: morton_before; equal coordinates by the bytes of their rows) as indices
// of rows. Depends on the set of rows alone. Fewer than 2^32 rows.
template <class Coord>
std::vector<std::uint32_t> morton_order(const std::byte* rows, std::size_t count, const RowLayout& layout,
                                        const AxisShift& finer);

extern template std::vector<std::uint32_t> morton_order<std::uint32_t>(const std::byte*, std::size_t, const RowLayout&,
                                                                       const AxisShift&);
extern template std::vector<std::uint32_t> morton_order<std::uint64_t>(const std::byte*, std::size_t, const RowLayout&,
                                                                       const AxisShift&);

}  // namespace pcm
