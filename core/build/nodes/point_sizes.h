// The sizes of the points of a bin, from the distances to their neighbours in it.
#pragma once

#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// The code of each point's size (tree/point_size.h): the distance to its fourth neighbour, of those at other places.
// They are searched among the 96 points around it in Morton order, which finds the fourth neighbour for more than half
// of the points, and for 99 of 100 a distance of at most twice it. So that points next to a gap, and those that stand
// alone, are no larger than those around, a size is at most one and a half times the middle one of 32 points, and 16
// times that of the bin.
// Neighbours beyond the bin do not count. `rows` are in Morton order; those of one place get one size.
template <class Coord>
std::vector<std::uint8_t> find_sizes(const std::byte* rows, std::size_t points, std::size_t row_bytes,
                                     const Grid& grid);

extern template std::vector<std::uint8_t> find_sizes<std::uint32_t>(const std::byte*, std::size_t, std::size_t,
                                                                    const Grid&);
extern template std::vector<std::uint8_t> find_sizes<std::uint64_t>(const std::byte*, std::size_t, std::size_t,
                                                                    const Grid&);

}  // namespace pcm
