// What a set of points holds: in numbers, and as a cloud of its own.
#pragma once

#include "pcm/convert/convert.h"
#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>

namespace pcm {

struct SetStatistics {
    std::uint64_t points = 0;
    Box3d box;                                      // around them, source coordinates; empty without points
    std::map<std::int64_t, std::uint64_t> classes;  // points of each value of `classification`, where the tree has it
};

// Reads the positions and classes of the set's points, once. Throws Error(cancelled), and what reading throws.
SetStatistics statistics_of(const PointSet& set, unsigned threads = 0, const ProgressFunction& progress = {});

// The set's points with all attributes, bit for bit, as TreeReader gives them. The set is copied.
std::unique_ptr<PointReader> open_set(const PointSet& set);

struct ExtractOptions {
    bool overwrite = false;                               // replace an output that exists
    WriteOptions write = on_all_processors();             // of files
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  // of a tree's build
    unsigned threads = 0;                                 // of a tree's build; 0: one per processor
    ProgressFunction progress;
};

// Writes the set's points as a tree or a file of any format, by the output's extension. Atomic as convert(), and throws
// what it throws; Error(invalid_argument) for an empty set.
ConvertReport extract_points(const PointSet& set, const std::filesystem::path& output,
                             const ExtractOptions& options = {});

}  // namespace pcm
