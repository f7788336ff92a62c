// Clouds of doubles read by the ranks of a team.
//
// Each rank reads ranges of points, or some files where these can only be read from their beginning, and keeps their
// rows in a spool a job, with what the choice of the grid needs. Rank 0 then chooses the cuts between bins from a
// sample: every n-th row of all spools. Last, rows are put on the grid and into bins, a spool a job.
#pragma once

#include "pcm/cluster/bin_rows.h"
#include "pcm/cluster/input_jobs.h"
#include "pcm/cluster/team_work.h"
#include "pcm/io/pipe/merged_reader.h"

namespace pcm {

// Whether the cloud is one that is read so, and ranks have something to share; nothing of it is left out.
bool can_be_spooled(const MergedReader& cloud, const ReadOptions& options);

// Collective, for such a cloud: as read_input(). `header`: its info before points were read.
AnyTop spool_input(const TeamWork& team_work, MergedReader& cloud, const FileInfo& header, Ingested& found,
                   BinRows& rows);

}  // namespace pcm
