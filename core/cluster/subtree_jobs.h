// The nodes of a team's tree: subtrees are built by the ranks, one a job, the nodes above them by rank 0, which then
// says where each chunk lies in the data files. Those are written by the ranks, one a job.
//
// Data files are those of one process byte for byte: chunks in post-order, up to 1 GiB a file, and the coarse levels in
// front.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/nodes/draft.h"
#include "pcm/cluster/level_jobs.h"
#include "pcm/cluster/sort_jobs.h"
#include "pcm/cluster/team_work.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

struct TeamTree {
    const Draft* root = nullptr;            // in rank 0; null for a cloud without points
    std::vector<std::uint64_t> data_files;  // size of each, in rank 0
};

// Collective: the data files are in `folder` then. The store belongs to rank 0's nodes.
template <class Coord>
TeamTree build_nodes(const TeamWork& team_work, const Ingested& cloud, const TopTree<Coord>& top, BinFiles<Coord>& bins,
                     const LevelFiles& levels, const std::filesystem::path& folder, DraftStore& drafts);

extern template TeamTree build_nodes(const TeamWork&, const Ingested&, const TopTree<std::uint32_t>&,
                                     BinFiles<std::uint32_t>&, const LevelFiles&, const std::filesystem::path&,
                                     DraftStore&);
extern template TeamTree build_nodes(const TeamWork&, const Ingested&, const TopTree<std::uint64_t>&,
                                     BinFiles<std::uint64_t>&, const LevelFiles&, const std::filesystem::path&,
                                     DraftStore&);

}  // namespace pcm
