// Adds points to a tree.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/io/reader.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

struct AppendOptions {
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  // for the whole operation; at least 64 MiB
    unsigned threads = 0;                                 // 0: one per processor
    std::uint32_t chunk_points = default_chunk_points;    // maximum number of points in a chunk, as in a build
    bool ignore_crs = false;  // coordinate systems and GPS times that differ from the tree's: note them, do not refuse
    ProgressFunction progress;
};

struct AppendReport {
    Outcome outcome;  // in: the new points; out: the tree's afterwards; error: the tree's largest position error
    std::uint64_t points_added = 0;
    // New points without a finite position, or beyond ReadOptions::largest_coordinate.
    std::uint64_t points_skipped = 0;
    Skipped skipped;  // bad lines and files
    std::uint64_t nodes_added = 0;
    std::uint64_t bytes_written = 0;
    std::uint32_t parts = 0;         // parts of the tree afterwards
    std::vector<std::string> notes;  // from the readers, and about attributes that the new points lack
};

// Adds all points of `cloud`, read to its end, in place and atomically. The new points become a part of their own.
// Existing points keep their nodes and levels; they are only read near the new points. `sources` are added to the
// tree's source names.
//
// The guarantee of the levels holds for old and new points together: those of levels 0..k are a maximal Poisson-disk
// sample at the spacing of k; in a tree of grid sampling, one point of each occupied lattice cell. Which points depends
// on the order of appending. The spacings of the levels stay; a tree without points gets new ones. The bytes written do
// not depend on the number of threads.
//
// Every new point must have a place on the tree's grid (fitted_reader.h) and no attribute that the tree lacks;
// attributes that it lacks itself become 0. The tree keeps its metadata; a tree that states no coordinate system takes
// over that of the new points, as notes report. Throws Error(invalid_argument) when points or attributes do not fit,
// when coordinate systems, units or GPS times differ (io/pipe/system_check.h), and for options out of range,
// Error(exists) when another process or thread changes the tree, and what reading and writing throw. After an error or
// a cancel the written files are removed, and the tree is the old one; what fails after the points have become part of
// the tree is a warning of the outcome. The cloud may be a reader of this tree.
AppendReport append_points(const std::filesystem::path& tree, PointReader& cloud,
                           const std::vector<std::string>& sources, const AppendOptions& options = {});

}  // namespace pcm
