// Rebuilds a tree from its points: one part, even levels, no unused bytes.
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
    std::uint64_t bytes_before = 0;  // size of the tree's folder
};

// The tree becomes what a build of its points would make: all parts are merged, the space of deleted points is freed,
// and levels with gaps from deletions are complete again. Grid, attributes, metadata, sources, and the counts and
// errors that the build and appends recorded stay. The new tree replaces the old one atomically, after the hashes of
// their points were compared. Until then it needs disk space in addition to the old one's. Where the tree's name is a
// symbolic link, the tree that it leads to is replaced, and the link stays. Open readers keep reading the old tree (a
// snapshot) where the system keeps open files alive. Throws Error(exists) when another process or thread changes the
// tree, or when its folder has files that do not belong to it, Error(corrupt) when the points read are not the ones
// that were stored, and what build_tree throws.
CompactReport compact_tree(const std::filesystem::path& tree, const CompactOptions& options = {});

}  // namespace pcm
