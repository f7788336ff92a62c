// What a set of points is changed by: saved as an attribute, classified, deleted.
//
// Each goes into a copy or into the tree itself (update/target.h), and is atomic: whatever ends it early, also a crash,
// a cancelled progress or a full disk, leaves the tree as it was, and no copy. A set belongs to one generation of the
// tree: afterwards sets of the changed tree must be selected again.
//
// All throw Error(invalid_argument) when the tree was changed since the points were selected, and for an empty set
// where that would change nothing; Error(exists) when another process or thread changes the tree; what UpdateTarget,
// reading and writing throw. What fails after the tree is changed is a warning of the outcome.
#pragma once

#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"
#include "pcm/update/erase.h"
#include "pcm/update/target.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace pcm {

struct SetChangeOptions {
    TargetChoice target;
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;  // of the cache
    unsigned threads = 0;                                   // 0: one per processor
    bool overwrite = false;  // save_as_attribute(): values that it did not make may be lost
    ProgressFunction progress;
};

struct SetChangeReport {
    Outcome outcome;             // in: points of the tree; out: points whose value was changed
    std::filesystem::path tree;  // that was changed or written
};

// Writes the attribute `name` (u8): 1 for the points of the set, 0 for all others; made when absent. A condition
// NAME=1 selects them again. An empty set is fine. Throws Error(invalid_argument) for an attribute of that name and
// another type; and, unless `overwrite`, for one that this function did not make, and for standard names, before
// anything is copied (filter/result_attributes.h: check_may_write()).
SetChangeReport save_as_attribute(const PointSet& set, const std::string& name, const SetChangeOptions& options);

// Sets an integer attribute of the points, made as u8 when absent. `value` is the raw value. Throws
// Error(invalid_argument) for an attribute that is not one integer, and for a value that its type cannot hold.
SetChangeReport classify_points(const PointSet& set, std::int64_t value, const std::string& attribute,
                                const SetChangeOptions& options);

// Deletes the points, see update/erase.h.
struct SetErasure {
    EraseReport report;
    std::filesystem::path tree;
};
SetErasure delete_points(const PointSet& set, const SetChangeOptions& options);

}  // namespace pcm
