// Rebuilds the index of a damaged tree from its chunks.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/system/tree_folder.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

struct RepairOptions {
    bool check_only = false;  // changes nothing; the report describes what would be done
    unsigned threads = 0;     // 0: one per processor
    ProgressFunction progress;
};

struct RepairReport {
    Outcome outcome;  // in: points that the tree should have, as far as recorded; out: points that it has now
    bool index_written = false;       // since it was damaged or missing, or named damaged chunks (check_only: would be)
    std::uint64_t points_lost = 0;    // in damaged chunks, as far as their number is recorded
    std::uint32_t generation = 0;     // generation of the tree that was restored
    std::vector<std::string> faults;  // damage, one line per chunk or file
    std::vector<std::string> healed;  // leftovers of an interrupted update that were removed (check_only: would be)
    // about.pct where it was damaged, missing or of another tree, and was restored (check_only: would be).
    std::vector<std::string> restored;
    // The tree as it is now was read from disk, with all that 'pcmlab verify' checks, and is undamaged.
    bool verified = false;
    // Whether the tree was undamaged: what verify_tree() finds, this finds too.
    bool whole() const { return faults.empty() && restored.empty() && !index_written; }
};

// Reads every chunk of every data file and checks all its bytes. Where the index and everything that it names are
// undamaged, only leftovers of interrupted updates are removed. Else the index is rebuilt from the newest undamaged
// chunk of each node among the generations whose update was completed; missing inner nodes are added without points.
// The new index replaces the old one atomically; the old one is kept as index.pct.damaged. A tree that lost only its
// index is restored node for node. Without about.pct the metadata, the names of sources and the number of skipped
// points are lost, as the report notes. A tree that was changed is verified as by verify_tree(); what is found then
// is among the faults. `path` is the tree folder. Throws Error(not_a_tree) when the folder has no
// chunk of a tree, Error(corrupt) when no point can be saved or a data file that is needed belongs to another tree,
// which the error names, Error(exists) when another process or thread changes the tree, Error(cancelled).
RepairReport repair_tree(const std::filesystem::path& path, const RepairOptions& options = {});

}  // namespace pcm
