// The numbers of the search for neighbours that no theory gives. The neighbours are exact whatever these are: they
// decide time and memory alone. "Chosen" says on which clouds each was chosen; bench_neighbourhoods --sweep draws the
// curve of a value again by its name (bench/README.md). Sizes that are part of a data structure stand where it is
// (unit_kernel.h, point_blocks.h, unit_tree.cpp).
#pragma once

#include <cstddef>

namespace pcm {

// How far around a unit points are loaded at first (unit_worker.h).
struct MarginTuning {
    // Points of a worker's first unit whose neighbours are searched one by one for its margin.
    // Chosen: not swept.
    std::size_t first_points = 32;  // points
    // The first margin: this quantile of their distances to the last neighbour, and a factor on it.
    // Chosen: not swept.
    double first_quantile = 0.9;  // share of the points
    // Chosen: with first_quantile; not swept.
    double first_factor = 1.3;  // factor on the distance
    // The margin of the next units, from the distances in the unit before.
    // Chosen: not swept.
    double next_quantile = 0.98;  // share of the points
    // Chosen: not by a curve of the time, which is flat within the noise of the machine; with 0.5, 1.1 and 1.7 of a
    // site of 1 M points (k 16) 770, 122 and 11 points are searched one by one (bench_neighbourhoods).
    double next_factor = 1.1;  // factor on the distance
};

// When points further around a unit are loaded, because the margin was too small for many of its points.
struct WidenTuning {
    // Fewer unresolved points than both are searched one by one.
    // Chosen: not swept.
    std::size_t min_points = 64;  // points
    // Chosen: with min_points; not swept.
    std::size_t points_per_unresolved = 300;  // points of the unit
    // Shares of the unresolved points that a wider margin resolves: the largest for which few enough points are loaded.
    // Chosen: not swept.
    double large_share = 0.99;  // share of the unresolved points
    // Chosen: with large_share; not swept.
    double middle_share = 0.8;  // share of the unresolved points
    // Chosen: with large_share; not swept.
    double small_share = 0.5;  // share of the unresolved points
    // Growth of the margin where fewer points than neighbours were loaded, so that no distance is known.
    // Chosen: not swept.
    double blind_growth = 4;  // factor on the margin
    // Maximum number of points to load: a multiple of the unit's, and a number.
    // Chosen: not swept.
    double max_unit_multiple = 3;  // points of the unit
    // Chosen: with max_unit_multiple; not swept.
    double max_more_points = 100000;  // points
};

// Points that are searched one by one in the whole tree.
struct SingleTuning {
    // Neighbours that are searched for in addition to k, because those at almost the same distance are ordered by the
    // exact distance, then by position.
    // Chosen: not swept.
    std::size_t spare_neighbours = 4;  // neighbours
};

struct KnnTuning {
    MarginTuning margin;
    WidenTuning widen;
    SingleTuning single;
};

// The values above, unless a benchmark has set one (tuned_values.h). Constant while anything works.
const KnnTuning& knn_tuning();

}  // namespace pcm
