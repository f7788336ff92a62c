// Bins that came out larger than planned, divided by the ranks of a team: one a job.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/cluster/bin_rows.h"
#include "pcm/cluster/team_work.h"

namespace pcm {

// Collective: divides the large bins of `rows`, and numbers nodes and bins as divide_large_bins() does.
template <class Coord>
void divide_bins(const TeamWork& team_work, const Ingested& cloud, TopTree<Coord>& top, BinRows& rows);

extern template void divide_bins(const TeamWork&, const Ingested&, TopTree<std::uint32_t>&, BinRows&);
extern template void divide_bins(const TeamWork&, const Ingested&, TopTree<std::uint64_t>&, BinRows&);

}  // namespace pcm
