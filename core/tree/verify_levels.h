// Measures how even the levels of a tree are.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

// The cloud at one level, that is the points of this level and those above. Distances are over the level's spacing.
struct LevelMeasure {
    double spacing = 0;         // source units
    std::uint64_t points = 0;   // of the cloud at this level
    double least_distance = 0;  // between any two of them; infinite for a single point
    double coverage = 0;  // largest distance from a point of the whole cloud to the nearest of them; infinite beyond 2
    // Spread of the distances to the nearest neighbour: standard deviation over mean, of points that have one within
    // twice the spacing, and how many have none.
    double variation = 0;
    std::uint64_t isolated = 0;
};

struct LevelsReport {
    std::vector<LevelMeasure> levels;  // all but a last one that holds the rest
    // What no coverage reaches: 1 in a tree as it was built or compacted. 2 after appending: a new point whose level
    // would bring it too near to a finer one that was there takes a later level; then it has that one near, which is
    // itself covered or near to a yet coarser one, and so on, each half as far as the next: less than twice the spacing
    // in all. Infinite after deleting.
    double coverage_limit = 1;
    std::vector<std::string> faults;  // where the levels are not what their kind of sampling promises
    double seconds = 0;
};

// Exact: every point is measured against every other that could matter, without the structures that the build used.
// Memory is bounded by some hundred MB; time grows with points times levels. `threads` 0: one a processor. Throws
// Error(cancelled) and what reading the tree throws.
LevelsReport verify_levels(const Tree& tree, unsigned threads = 0, const ProgressFunction& progress = {});

}  // namespace pcm
