// Levels by a lattice: the first point in Morton order of each cell belongs to the cell's level. Quicker than a
// Poisson-disk sample, and less even. Cells of every size are runs in Morton order (lattice.h), so one pass over the
// points finds all levels: a point is the first of its cell for all sizes up to the one that separates it from the
// point before.
#pragma once

#include "pcm/build/levels/given_levels.h"
#include "pcm/build/levels/sorted_points.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// For each size up to `top`: how many points are the first of a cell of this size, and of no larger one (up to `top`).
// The bin has points.
template <class Coord>
std::array<std::uint32_t, 65> count_first_of_cells(typename SortedPoints<Coord>::Reader& points, const AxisShift& finer,
                                                   int top);

// The level of each point; `sizes`: cell size of each level, descending by one. The points that are first of no such
// cell get level sizes.size().
template <class Coord>
std::vector<std::uint8_t> grid_levels(typename SortedPoints<Coord>::Reader& points, const AxisShift& finer,
                                      const std::vector<int>& sizes);

// The same where cells may hold given points: none of those that do gets a level from this bin. `box`: the bin's.
template <class Coord>
std::vector<std::uint8_t> grid_levels_beside(typename SortedPoints<Coord>::Reader& points,
                                             const typename SortedPoints<Coord>::Box& box, const Lattice& lattice,
                                             const std::vector<int>& sizes, const GivenLevels<Coord>& given);

}  // namespace pcm
