// Filters whose result is another cloud: as a new tree, or in the place of the tree that they read.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/io/reader.h"
#include "pcm/tree/tree.h"
#include "pcm/update/target.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace pcm {

struct ResultOptions {
    TargetChoice target;                                  // `copy` names the new tree; it has its own data files
    bool overwrite = false;                               // replace `copy` if it is a tree
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  // of filter and build; at least least_build_memory
    unsigned threads = 0;                                 // 0: one per processor
    std::uint32_t chunk_points = default_chunk_points;
    std::optional<Sampling> sampling;  // absent: that of the tree that is read
    ProgressFunction progress;

    std::uint64_t reader_memory() const { return memory_bytes / 4; }
};

// Builds the tree of the cloud that `filter` makes of a tree. In place it replaces that tree atomically when it is
// complete; the tree is locked until then, and open readers keep reading the old one (a snapshot). After an error or a
// cancel the tree is the old one, and nothing is left of the new one. The sources that the tree names are carried over.
// Throws Error(invalid_argument) unless exactly one target is chosen or when `copy` is the tree itself, Error(exists)
// when another process or thread changes the tree in place, and what Tree::open, `filter` and build_tree throw.
BuildReport build_result(const std::filesystem::path& tree, const ResultOptions& options,
                         const std::function<std::shared_ptr<PointReader>(std::shared_ptr<const Tree>)>& filter);

}  // namespace pcm
