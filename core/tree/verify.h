// Checks a whole tree: checksums, counts, boxes of nodes and segments, levels, the identity of each chunk, the presence
// of every point exactly once, and the files around the index.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/tree/tree.h"

#include <string>
#include <vector>

namespace pcm {

class Team;

struct VerifyReport {
    Outcome outcome;
    std::uint64_t bytes = 0;
    double position_error = 0;        // as recorded by the build
    std::vector<std::string> faults;  // empty: the tree is undamaged
    // about.pct is damaged, missing or differs from the index. No point is lost, and 'pcmlab repair' restores the file.
    std::vector<std::string> around;
    // Files and bytes that do not belong to the tree, and leftovers of an interrupted update.
    std::vector<std::string> notes;
};

// Reads every chunk on `threads` threads (0: one per processor). Damage is reported as faults. Throws what Tree::open
// throws, Error(cancelled), and where memory or threads run out std::bad_alloc or std::system_error, none of which is
// damage. `progress` is called on this thread; what it throws reaches the caller.
VerifyReport verify_tree(const std::filesystem::path& path, unsigned threads = 0,
                         const ProgressFunction& progress = {});

// Collective: the same by several processes, which take chunks from the team's counter `counter` (threads/team.h). The
// report is that of one process in rank 0; the others have its `faults` and `around`, and nothing else.
VerifyReport verify_tree(const std::filesystem::path& path, unsigned threads, const ProgressFunction& progress,
                         Team& team, std::uint64_t counter);

}  // namespace pcm
