// What the stages of a team's build share.
#pragma once

#include "pcm/build/bins/workspace.h"
#include "pcm/build/builder.h"
#include "pcm/cluster/job_folder.h"
#include "pcm/threads/team.h"

#include <cstdint>

namespace pcm {

// Counters of the team (threads/team.h), one a stage.
enum JobCounter : std::uint64_t {
    count_batches,
    count_divisions,
    count_bins,
    count_subtrees,
    count_data_files,
    count_chunks,
    count_units,
    count_nodes,
    count_spools,
    count_samples,
    count_spooled
};

struct TeamWork {
    Team& team;
    const JobFolder& jobs;
    Workspace& work;
    const BuildOptions& options;
};

}  // namespace pcm
