// One pass over the places of a set's points.
#pragma once

#include "pcm/query/point_set.h"
#include "pcm/select/point_scan.h"
#include "pcm/system/progress.h"

#include <functional>
#include <string>
#include <vector>

namespace pcm {

// Calls take() once for each node with points of the set, with their source coordinates, on any thread, several at the
// same time. Throws what scan_points() throws.
void scan_positions(const PointSet& set, const std::string& stage, unsigned threads, const ProgressFunction& progress,
                    const std::function<void(const ScannedPoints&, const std::vector<Vec3d>&)>& take);

}  // namespace pcm
