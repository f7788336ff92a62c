// Builds a tree folder from files, out of core; core/README.md describes the stages.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/system/progress.h"
#include "pcm/tree/chunk_size.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

// Bounds that check_build_options() holds options to; those of chunk_points are in tree/chunk_size.h.
inline constexpr std::uint64_t least_build_memory = std::uint64_t(64) << 20;
inline constexpr unsigned most_build_threads = 1024;

struct BuildOptions {
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  // for the whole build; at least least_build_memory
    unsigned threads = 0;                                 // 0: one per processor
    std::uint32_t chunk_points = default_chunk_points;    // maximum points per chunk
    Sampling sampling = Sampling::poisson;                // how the points of a level are chosen
    bool overwrite = false;                               // replace an existing tree (only ever a tree)
    bool resume = true;  // resume an interrupted build, and write checkpoints so that this one can be resumed
    double checkpoint_seconds = 1;  // between checkpoints; 0: as many as possible
    ReadOptions read{0, {}};        // how files are read; threads 0: one per processor
    ProgressFunction progress;
};

struct BuildReport {
    Outcome outcome;                   // error: largest position error, source units
    std::uint64_t points_skipped = 0;  // without a finite position, or beyond ReadOptions::largest_coordinate
    Skipped skipped;                   // bad lines and files
    std::uint64_t bytes = 0;           // size of the tree folder
    std::uint64_t scratch_bytes = 0;   // peak size of scratch files on disk
    std::uint64_t nodes = 0;
    std::uint16_t levels = 0;
    std::vector<std::string> notes;  // from the readers, and about merged schemas
};

// Reads `inputs` (files, and folders as expand_inputs() expands them) as one cloud and writes the tree folder `output`.
//
// The same input and chunk_points give the same bytes, whatever the memory and the number of threads. The tree is built
// in the folder `output`.part and appears under its name when it is complete, so an interrupted build is never taken
// for a tree. A build of the same files (by path, size and modification time) with the same options, but for memory and
// threads, resumes an interrupted one at its last checkpoint and makes the same tree byte for byte; any other build
// removes its remains and starts from the beginning. The report's notes name them. Inputs that take less than
// checkpoint_seconds to read get no checkpoints. An error or a cancel removes everything that was written; what fails
// after the tree has its name is a warning of the outcome. A tree that is overwritten stays until the new one replaces
// it, atomically where the system can do that (build_folder.h describes the state after a crash where it cannot). Where
// `output` is a symbolic link, the tree that it leads to is replaced. Throws Error(exists) when `output` exists (with
// overwrite: exists and is not a tree, or its folder has files that do not belong to the tree) or is being built by
// another process, Error(invalid_argument) for options out of range, for a place inside a tree's folder and for
// positions that no grid of a tree holds (bins/position_grid.h), and whatever the readers and the file system throw.
BuildReport build_tree(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                       const BuildOptions& options = {});

// The same for any cloud, which is read to its end; `sources` are the names that the tree records as its origin. The
// cloud must not read from the tree that is overwritten. Such a build cannot be resumed.
BuildReport build_tree(PointReader& cloud, const std::vector<std::string>& sources, const std::filesystem::path& output,
                       const BuildOptions& options = {});

// Builds another tree of the points of a tree. `like` is the first tree's info: its grid and its origin (type of
// positions, sources, metadata, position error, skipped points) are carried over. `cloud` has the points on this grid,
// as FittedReader gives them (update/fitted_reader.h). Throws Error(corrupt) when the hash of the points is not the one
// in `like`.
BuildReport rebuild_tree(PointReader& cloud, const TreeInfo& like, const std::filesystem::path& output,
                         const BuildOptions& options = {});

// Throws Error(invalid_argument) for options out of range.
void check_build_options(const BuildOptions& options);

}  // namespace pcm
