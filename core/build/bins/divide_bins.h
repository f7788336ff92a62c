// Bins that came out larger than planned are divided again: a sample can miss a dense spot.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/bins/cut.h"
#include "pcm/build/bins/workspace.h"

#include <cstdint>

namespace pcm {

// Divides every bin of more than 1.5 * `bin_points` rows, on all threads of the workspace. By cuts where the points can
// be parted; a pile of points in one place becomes bins that overlap. The result depends on the rows alone, not on
// their order. Throws what reading and writing the scratch file throws, and Error(cancelled).
template <class Coord>
void divide_large_bins(Bins<Coord>& bins, Workspace& work, const AxisShift& finer, std::uint64_t bin_points);

extern template void divide_large_bins(Bins<std::uint32_t>&, Workspace&, const AxisShift&, std::uint64_t);
extern template void divide_large_bins(Bins<std::uint64_t>&, Workspace&, const AxisShift&, std::uint64_t);

}  // namespace pcm
