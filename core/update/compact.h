// Writes a tree anew: one part, even levels, nothing but its points.
#pragma once

#include "pcm/build/builder.h"

#include <cstdint>
#include <filesystem>

namespace pcm {

struct CompactOptions {
    std::filesystem::path output;                         // another tree to write; empty: in place
    bool overwrite = false;                               // replace `output` if it is a tree
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  // as in a build
    unsigned threads = 0;
    std::uint32_t chunk_points = default_chunk_points;
    ProgressFunction progress;
};

struct CompactReport {
    BuildReport build;
    std::uint64_t bytes_before = 0;  // of the tree's folder
};

// The tree becomes what a build of its points would make: every part in one, deleted points' space given back, levels
// that keep their promise where deletions had left gaps. Grid, attributes, metadata, sources, and the counts and errors
// that the build and appends told stay. Points are compared by their hash before the new tree takes the place of the
// old one, which it does at once. The new tree needs its space beside the old one until then. Who has the old one open
// goes on reading it where the system keeps open files alive. Throws Error(exists) when somebody else changes the tree,
// Error(corrupt) when the points that were read are not those that were written once, and what build_tree throws.
CompactReport compact_tree(const std::filesystem::path& tree, const CompactOptions& options = {});

}  // namespace pcm
