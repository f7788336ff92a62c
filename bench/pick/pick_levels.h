// Picks among the points that are in memory, one depth of the tree after the other.
#pragma once

#include "pcm/pick/point_picker.h"
#include "pcm/point_cloud.h"

#include <vector>

namespace pcm::bench {

// With the nodes of depth 0, of 0 to 1, ... and all of them in the cache, and exact picks from disk and from the cache:
// a line of JSON each with "nodes", "points" (in memory), "cpu_seconds" (of a pick, the mean), "missed_percent" (rays
// that hit a point of the whole cloud and none here) and "error_p95" (how much deeper the hit is than the exact one,
// source units; a missed one counts as the cloud's diagonal). The cache has to have room for all.
void print_levels(PointCloud& cloud, const std::vector<PickRay>& rays);

}  // namespace pcm::bench
