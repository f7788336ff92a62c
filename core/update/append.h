// Adds points to a tree.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/io/reader.h"
#include "pcm/build/builder.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

struct AppendOptions {
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  // for the whole operation; at least 64 MiB
    unsigned threads = 0;                                 // 0: one a processor
    std::uint32_t chunk_points = default_chunk_points;    // most points of a chunk, as in a build
    ProgressFunction progress;
};

struct AppendReport {
    Outcome outcome;  // in: the new points; out: the tree's afterwards; error: the tree's largest position error
    std::uint64_t points_added = 0;
    std::uint64_t points_skipped = 0;  // of the new ones, without a finite position
    std::uint64_t nodes_added = 0;
    std::uint64_t bytes_written = 0;
    std::uint32_t parts = 0;         // of the tree now
    std::vector<std::string> notes;  // from the readers, and about attributes that the new points lack
};

// Adds all points of `cloud`, read to its end, in place and at once: at any instant the tree is the old one or the new
// one. The new points become a part of their own; what is there stays as it is, and is not read but near the new
// points. `sources` join the names that the tree remembers as its origin.
//
// Levels keep their promise: the points of levels 0..k of old and new together are a maximal Poisson-disk sample at the
// spacing of k; in a tree of grid sampling, one point of each lattice cell that has any. Which ones depends on what was
// there first. The ladder of spacings stays; a tree without points gets one. The same bytes for any number of threads.
// A new point must have a place on the tree's grid (tree_rows.h) and no attribute that the tree has not; attributes
// that it lacks are 0. Throws Error(invalid_argument) when points or attributes do not fit, and for options out of
// range, Error(exists) when somebody else changes the tree, and what reading and writing throw. On an error or a cancel
// what was written is removed. The cloud may be this tree itself.
AppendReport append_points(const std::filesystem::path& tree, PointReader& cloud,
                           const std::vector<std::string>& sources, const AppendOptions& options = {});

}  // namespace pcm
