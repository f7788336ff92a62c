// Measures how evenly the points of a tree's levels are spread.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

// The cloud at one level: the points of this level and of all coarser ones. Distances are in units of the level's
// spacing.
struct LevelMeasure {
    double spacing = 0;         // source units
    std::uint64_t points = 0;   // number of points of the cloud at this level
    double least_distance = 0;  // minimum distance between any two of these points; infinite for a single point
    // Maximum distance from a point of the whole cloud to the nearest of these points; infinite beyond 2.
    double coverage = 0;
    // Variation of the distances to the nearest neighbour (standard deviation over mean) among the points with a
    // neighbour within twice the spacing, and the number of points without one.
    double variation = 0;
    std::uint64_t isolated = 0;
};

struct LevelsReport {
    std::vector<LevelMeasure> levels;  // all but a last level with spacing 0
    // Upper bound of every level's coverage: 1 in a tree as it was built or compacted. 2 after appending: a new point
    // that would be too near to an existing point of a finer level moves to a finer level itself; it then has that
    // point near, which is covered or near to a point of a coarser level, and so on, each distance half of the next
    // one: less than twice the spacing in all. Infinite after deleting.
    double coverage_limit = 1;
    std::vector<std::string> faults;  // violations of what the kind of sampling guarantees
    double seconds = 0;
};

// Exact: every point is compared with every other point that could matter, independently of the structures that the
// build used. Memory is bounded by some hundred MB; time grows with points times levels. `threads` 0: one per
// processor. `tile_points`: number of a level's points that a thread measures together, which changes the memory, and
// the result by rounding alone. Throws Error(cancelled) and what reading the tree throws.
LevelsReport verify_levels(const Tree& tree, unsigned threads = 0, const ProgressFunction& progress = {},
                           std::size_t tile_points = 250'000);

}  // namespace pcm
