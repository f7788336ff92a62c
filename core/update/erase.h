// Deletes points of a tree.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/cloud/selection.h"

#include <cstdint>
#include <filesystem>

namespace pcm {

struct EraseOptions {
    unsigned threads = 0;     // 0: one a processor
    bool count_only = false;  // nothing is changed, the report says what would be
    ProgressFunction progress;
};

struct EraseReport {
    Outcome outcome;  // in: the tree's points before; out: after
    std::uint64_t points_deleted = 0;
    std::uint64_t nodes_rewritten = 0, nodes_emptied = 0;
    std::uint64_t bytes_written = 0;
    bool coverage_kept = true;  // levels are still as even as they were: only points of the last level went
};

// Deletes the points that `selection` chooses, in place and at once: at any instant the tree is the old one or the new
// one. Nodes that the selection's bounds do not touch are not read. Nodes that lose points are written anew behind the
// others; what they took before is free after compact_tree(). The points that stay keep their levels: no two of a level
// are nearer than its spacing, but where its points went there may be none near enough, until the tree is compacted. A
// tree may lose all its points: it is then an empty one. Who has it open goes on reading what was there before. Throws
// Error(invalid_argument) when the selection chooses no points or names what the tree has not, Error(exists) when
// somebody else changes the tree, and what reading and writing throw.
EraseReport erase_points(const std::filesystem::path& tree, const Selection& selection,
                         const EraseOptions& options = {});

}  // namespace pcm
