// Filters whose result is another cloud: as a new tree, as a file of any format that is written, or in the place of the
// tree that they read.
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
#include <string>
#include <vector>

namespace pcm {

struct ResultOptions {
    // `copy` names the new tree, which has its own data files; or a file, by its extension (.laz, .ply, ...).
    TargetChoice target;
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  // memory of filter and build; least_build_memory or more
    unsigned threads = 0;                                 // 0: one per processor
    std::uint32_t chunk_points = default_chunk_points;
    std::optional<Sampling> sampling;  // absent: that of the tree that is read
    ProgressFunction progress;

    std::uint64_t reader_memory() const { return memory_bytes / 4; }
};

// Where a result of this name is put: output_file() or output_tree() of it (system/output_path.h), by the extension.
// Throws what these throw, and Error(exists) for what exists, unless `overwrite`.
std::filesystem::path result_place(const std::filesystem::path& copy, bool overwrite);

// Makes a tree or a file, by the extension: build_tree(), or write_cloud() of convert/convert.h, which may call `open`
// twice. The report of a file has no nodes and levels. Throws what result_place() and these throw.
BuildReport build_or_write(const std::function<std::unique_ptr<PointReader>()>& open,
                           const std::vector<std::string>& sources, const std::filesystem::path& output,
                           const BuildOptions& options);

// Builds the tree of the cloud that `filter` makes of a tree. In place it replaces that tree atomically when it is
// complete; the tree is locked until then, and open readers keep reading the old one (a snapshot). After an error or a
// cancel the tree is the old one, and nothing is left of the new one. The sources that the tree names are carried over.
// Where `copy` names a file, the cloud is written to it, and `filter` may be called twice.
// Throws Error(invalid_argument) unless exactly one target is chosen or when `copy` is the tree itself, Error(exists)
// when another process or thread changes the tree in place, and what Tree::open, `filter` and build_tree throw.
BuildReport build_result(const std::filesystem::path& tree, const ResultOptions& options,
                         const std::function<std::shared_ptr<PointReader>(std::shared_ptr<const Tree>)>& filter);

}  // namespace pcm
