// Checks a tree by several processes.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/threads/team.h"
#include "pcm/tree/verify.h"

#include <filesystem>

namespace pcm {

// Collective: as verify_tree(), and the same findings, whatever the number of ranks. Ranks read the tree's chunks by
// shares; the rest is checked by rank 0. The report is rank 0's; the others have its `faults` and `around` alone.
VerifyReport verify_tree_by(Team& team, const std::filesystem::path& tree, unsigned threads = 0,
                            const ProgressFunction& progress = {});

}  // namespace pcm
