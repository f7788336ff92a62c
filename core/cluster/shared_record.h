// What all ranks of a team need of one job.
#pragma once

#include "pcm/cluster/job_folder.h"
#include "pcm/threads/team.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace pcm {

// Collective: the record of the job, which is not empty. Where the job is not done, all ranks call make(), and what it
// returns in rank 0 is written when all have returned.
template <class Make>
std::vector<std::byte> find_or_make(Team& team, const JobFolder& jobs, const JobFolder::Key& job, const Make& make)
{
    std::vector<std::byte> record;
    if (team.rank() == 0) record = jobs.record_if_done(job).value_or(std::vector<std::byte>());
    record = team.broadcast(0, std::move(record));
    if (!record.empty()) return record;
    record = make();
    team.wait();
    if (team.rank() == 0) jobs.write(job, {}, record);
    return team.broadcast(0, std::move(record));
}

}  // namespace pcm
