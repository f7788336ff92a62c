// Builds a tree by several processes that share a folder.
#pragma once

#include "pcm/build/build_then.h"
#include "pcm/threads/team.h"

#include <filesystem>
#include <vector>

namespace pcm {

// Collective: as build_tree_then(), and the same bytes, whatever the number of ranks. All ranks have the same inputs,
// output and options, except for threads and progress, which are each rank's own; memory is for each of them. All see
// the files by the same names.
//
// The folder `output`.part holds what is done as files of jobs (job_folder.h). A build of the same files that was
// interrupted, at any moment, is resumed by the same call with any number of ranks: jobs that are done are not done
// again. The folder stays until the tree has its name, also after an error. `then` runs in rank 0, whose report is the
// build's; the others' are empty.
//
// No locks of the file system are needed. Where it has some, rank 0 holds one, so that a second build of the same tree
// is refused.
BuildReport build_tree_by(Team& team, const std::vector<std::filesystem::path>& inputs,
                          const std::filesystem::path& output, const BuildOptions& options,
                          const WorkOnTree& then = {});

}  // namespace pcm
