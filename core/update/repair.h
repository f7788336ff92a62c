// Puts a tree together again from its chunks.
#pragma once

#include "pcm/system/progress.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

inline constexpr const char* damaged_index_name = "index.pct.damaged";

struct RepairOptions {
    bool check_only = false;  // nothing is changed, the report says what would be
    unsigned threads = 0;     // 0: one a processor
    ProgressFunction progress;
};

struct RepairReport {
    Outcome outcome;  // in: points that the tree should have, where something says; out: those that it has now
    bool index_written = false;     // the index was damaged or missing, or named damaged chunks (check_only: would be)
    std::uint64_t points_lost = 0;  // in damaged chunks, as far as something tells how many they were
    std::uint32_t generation = 0;   // the state of the tree that was found
    std::vector<std::string> faults;  // what is damaged, chunk by chunk, file by file
    std::vector<std::string> healed;  // leftovers of an interrupted update that were removed (check_only: would be)
    std::vector<std::string> notes;   // what was written anew beside the index
    bool whole() const { return faults.empty() && !index_written; }
};

// Reads every chunk of every data file and checks it to the last byte. Where the index holds and all that it names is
// whole, only leftovers of interrupted updates are removed. Else the index is made anew: of each node the newest chunk
// of a generation whose update was finished, without those that are damaged; nodes without a chunk come to be between
// others. It takes the place of the old one at once, which is kept as index.pct.damaged. A tree whose index is lost is,
// node for node, what it was. Without about.pct too, the metadata, the names of sources, and the number of skipped
// points are lost, which is told. `path` is the tree folder. Throws Error(not_a_tree) when there is no chunk of a tree
// in the folder, Error(corrupt) when no point can be saved, Error(exists) when somebody else changes the tree.
RepairReport repair_tree(const std::filesystem::path& path, const RepairOptions& options = {});

}  // namespace pcm
