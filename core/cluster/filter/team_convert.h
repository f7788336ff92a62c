// A tree, or the part of it that is selected, written as a file or another tree by several processes.
#pragma once

#include "pcm/convert/convert.h"
#include "pcm/threads/team.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace pcm {

// Collective: as convert() of one tree, and the same bytes, whatever the number of ranks. All ranks have the same
// arguments, except for threads and progress, which are each rank's own; memory is for each of them. `request`: bytes
// that differ for conversions with other inputs, outputs or options, such as the command line.
//
// The ranks read the tree's chunks and select points, some chunks a job, whose points are a file in the folder
// OUTPUT.pct.part: after an interruption the same call with any number of ranks resumes it. Rank 0 writes the output of
// these points. The report is rank 0's; the others' are empty. Throws Error(unsupported) for inputs that are not one
// tree.
ConvertReport convert_by(Team& team, const std::vector<std::filesystem::path>& inputs,
                         const std::filesystem::path& output, const ConvertOptions& options,
                         const std::vector<std::byte>& request);

}  // namespace pcm
