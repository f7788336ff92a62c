// What the stages of a team's build share.
#pragma once

#include "pcm/build/bins/workspace.h"
#include "pcm/build/builder.h"
#include "pcm/cluster/job_folder.h"
#include "pcm/threads/team.h"

#include <cstdint>

namespace pcm {

// Counters of share_jobs(), one a stage.
enum JobCounter : std::uint64_t { count_batches, count_divisions, count_bins, count_subtrees, count_data_files };

struct TeamWork {
    Team& team;
    const JobFolder& jobs;
    Workspace& work;
    const BuildOptions& options;
};

}  // namespace pcm
