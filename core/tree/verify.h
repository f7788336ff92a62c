// Checks a whole tree: checksums, counts, boxes of nodes and segments, levels, that each chunk is its node's, that
// every point is there once, and the files around the index.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/tree/tree.h"

#include <string>
#include <vector>

namespace pcm {

struct VerifyReport {
    Outcome outcome;
    std::uint64_t bytes = 0;
    double position_error = 0;        // as recorded by the build
    std::vector<std::string> faults;  // empty: the tree is whole
    std::vector<std::string>
        around;  // about.pct is damaged, missing, or says otherwise: no point is lost, and 'pcmlab repair' heals it
    std::vector<std::string> notes;  // files and bytes that are not the tree's, and what an interrupted update has left
};

// Reads every chunk on `threads` threads (0: one a processor). Damage is reported as faults; Error is thrown only when
// the tree cannot be opened at all, or Error(cancelled).
VerifyReport verify_tree(const std::filesystem::path& path, unsigned threads = 0,
                         const ProgressFunction& progress = {});

}  // namespace pcm
