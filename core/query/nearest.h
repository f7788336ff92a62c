// The points nearest to a point, and the first one that a ray or a cone meets: exactly, or at a precision.
//
// Distances are computed in double: with p the source coordinates of a point and q the query point, the squared
// distance is (dx * dx + dy * dy) + dz * dz with dx = p.x - q.x and so on. Order is by (squared distance, node, index),
// so results depend on the tree alone. The only approximation is what the level leaves out, and the results report its
// size. Where a tree rounds its coordinates to the source's numbers (tree/source_rounding.h), points are chosen by
// their places on the grid, which differ from those by less than the last bits of the axis' largest coordinate;
// positions and distances of the results are those of the source's numbers.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/region.h"
#include "pcm/knn/point_search.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace pcm {

struct NearestOptions {
    std::optional<std::uint16_t> level;  // only points of the cloud at this level; the whole cloud when absent
    double max_distance = std::numeric_limits<double>::infinity();  // source units; compared by squares, inclusive
    unsigned threads = 0;                                           // threads of many searches; 0: one per processor
    ProgressFunction progress;                                      // progress of many searches
};

// Every point of the cloud has a point of the level nearer than the level's spacing s. So when the nearest point of the
// level lies at distance d, no point of the cloud is nearer than d - s; and the distance of the i-th nearest point of
// the level is at least that of the i-th nearest of the whole cloud.
struct NearestResult {
    std::vector<Neighbour>
        points;                 // nearest first; fewer than asked for when the cloud has no more (within max_distance)
    double least_distance = 0;  // no point of the whole cloud is nearer
    Outcome outcome;  // points_in: compared; error: by how much a point of the whole cloud may be nearer, source units
};

struct NearestBatch {
    std::vector<Neighbour> points;       // results of all searches, one search after another
    std::vector<std::size_t> first;      // first result of each search in `points`, and the end
    std::vector<double> least_distance;  // one for each search
    Outcome outcome;                     // error: the largest of any search
};

struct Hit {
    NodeId node = no_node;
    std::uint32_t index = 0;
    double along = 0;  // distance from the origin, measured along the ray
    Vec3d position{};
};

struct HitResult {
    std::optional<Hit> hit;  // ties: lower node, lower index
    Outcome outcome;         // error: every point of the whole cloud has one of the level nearer than this
};

// What a level leaves out: every point of the cloud has a point of the level nearer than this. 0 where the level is the
// whole cloud, infinite where nothing is promised (points were deleted since the levels were made).
double level_spacing(const Tree& tree, std::uint16_t level);

// Memory: up to 16 chunks, in addition to the cache's, for a search, or for each thread of many searches. Throw
// Error(invalid_argument) for a point that is not finite, a negative max_distance, or a region that is neither ray nor
// cone; and what reading throws.
NearestResult find_nearest(L2Cache& cache, BlockCache& blocks, const Vec3d& point, std::size_t k,
                           const NearestOptions& options);
// The same for many points; neighbouring ones share chunks, whatever their order. Memory: also the results.
NearestBatch find_nearest(L2Cache& cache, BlockCache& blocks, const std::vector<Vec3d>& points, std::size_t k,
                          const NearestOptions& options);
// The point in a ray or cone that is nearest along its axis.
HitResult find_first_hit(L2Cache& cache, BlockCache& blocks, const Region& beam,
                         const std::optional<std::uint16_t>& level);

}  // namespace pcm
