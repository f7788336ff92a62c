// The first stages of a team's build: the cloud is sampled by all ranks and its cuts are chosen by one; then batches of
// its points are read by all, and what came out too large is divided.
//
// Batches are ranges of a cloud of integers whose readers can seek (LAS, LAZ). Doubles are kept in spools before they
// get to their bins (spool_jobs.h). A single file that can only be read from its beginning, such as one of text, is
// read by rank 0 alone, as build_tree() reads it.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/cluster/bin_rows.h"
#include "pcm/cluster/team_work.h"
#include "pcm/io/pipe/merged_reader.h"

#include <variant>

namespace pcm {

using AnyTop = std::variant<TopTree<std::uint32_t>, TopTree<std::uint64_t>>;

// Collective. Fills `found` and `rows`, the same in all ranks, and returns the cuts between the bins.
AnyTop read_input(const TeamWork& team_work, MergedReader& cloud, Ingested& found, BinRows& rows);

}  // namespace pcm
