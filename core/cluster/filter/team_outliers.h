// Points that stand apart from the others: removed or labelled by several processes.
#pragma once

#include "pcm/filter/outliers.h"
#include "pcm/threads/team.h"
#include "pcm/update/target.h"

#include <filesystem>

namespace pcm {

// Collective: as remove_outliers() on UpdateTarget(tree, choice), and the same bytes, whatever the number of ranks. All
// ranks have the same arguments, except for threads and progress, which are each rank's own; memory is for each of
// them. `choice` is ignored where points are only counted.
//
// The neighbours of all points are searched by the ranks, unit by unit, and kept as files of jobs in the folder
// NAME.part next to the result: after an interruption the same call with any number of ranks resumes it. Rank 0 finds
// the threshold and writes the tree. The report is rank 0's; the others' are empty.
OutlierReport remove_outliers_by(Team& team, const std::filesystem::path& tree, const TargetChoice& choice,
                                 const OutlierOptions& options);

}  // namespace pcm
