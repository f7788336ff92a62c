// Bins that came out larger than planned are divided again: a sample can miss a dense spot.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/bins/cut.h"
#include "pcm/build/bins/workspace.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// A bin that was divided: the first of the nodes and of the bins that this added, which follow one another.
struct Division {
    std::uint32_t node, first_node;
    std::size_t first_bin;
};

// Divides every bin of more than 1.5 * `bin_points` rows, on all threads of the workspace. By cuts where the points can
// be parted; a pile of points in one place becomes bins that overlap. The result depends on the rows alone, not on
// their order. Returns the divisions, in their order. Throws what reading and writing the scratch file throws, and
// Error(cancelled).
template <class Coord>
std::vector<Division> divide_large_bins(Bins<Coord>& bins, Workspace& work, const AxisShift& finer,
                                        std::uint64_t bin_points);

// Whether a bin of this number of rows is divided.
inline bool is_large_bin(std::uint64_t rows, std::uint64_t bin_points) { return rows > bin_points + bin_points / 2; }

extern template std::vector<Division> divide_large_bins(Bins<std::uint32_t>&, Workspace&, const AxisShift&,
                                                        std::uint64_t);
extern template std::vector<Division> divide_large_bins(Bins<std::uint64_t>&, Workspace&, const AxisShift&,
                                                        std::uint64_t);

}  // namespace pcm
