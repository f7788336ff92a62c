// The precision of attributes computed from neighbours: the level that a time limit or an error target allows, and the
// error of a result, measured on random points against the exact answer.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/filter/attribute_pass.h"
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/filter/pilot.h"
#include "pcm/threads/watch.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

struct PointPlace {
    NodeId node = no_node;
    std::uint32_t index = 0;  // in the node's chunk
    bool operator<(const PointPlace& o) const { return node != o.node ? node < o.node : index < o.index; }
};

// `count` points, each of the cloud's equally likely each time, in ascending order; the same for the same seed. None of
// an empty cloud.
std::vector<PointPlace> random_points(const Tree& tree, std::size_t count, std::uint64_t seed);

// Compares what the cache holds with the exact values, at 1000 random points of a fixed seed, and adds
// `points_checked` and one SampledError for each of radii, normals, curvature and mean distances that is wanted:
// - radii and mean distances: in % of the exact value;
// - normals: the angle between the two lines, in degrees, where both are defined, else 90;
// - curvature: in % of its range, 1/3.
void check_errors(L2Cache& cache, const NeighbourAttributeOptions& options, const AttributePlaces& places,
                  NeighbourAttributeReport& report);

// The level for options.time_limit and options.error_target_percent; none when all points are to be computed.
// - Error target: the coarsest level at which 95 % of 300 random points have no larger error, by searches around those
//   points and their nearest points of each level alone.
// - Time limit: the finest level that is predicted to be done in time, from the time that a short run of the search
//   takes per point and the time that some chunks take to be written; level 0 where none is, which is noted.
// Where they disagree the time limit holds, which is noted.
// `predicted`, unless it is null, gets what the time limit was held against.
std::optional<std::uint16_t> choose_level(L2Cache& cache, const NeighbourAttributeOptions& options,
                                          const AttributePlaces& places, Watch& watch, std::vector<std::string>& notes,
                                          std::optional<PredictedTime>* predicted = nullptr);

// The ranks (0: the smallest) of two of `count` random values, between which the largest value of 95 % of what they
// were drawn from lies with 95 % probability, by the binomial distribution of how many are below it. The largest one's,
// where there are too few to bound it.
std::pair<std::size_t, std::size_t> ranks_around_p95(std::size_t count);

}  // namespace pcm
