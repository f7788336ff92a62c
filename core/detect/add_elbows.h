// Elbows as primitives of a detection, with points of their own.
#pragma once

#include "pcm/detect/detect.h"
#include "pcm/detect/elbow_search.h"

#include <cstddef>

namespace pcm {

// Adds the elbows that find_elbows() finds to the primitives of the report, with the points on them that belong to
// nothing else. Pieces of elbows are left out, and their points are the elbows'. As before, most points come first, and
// labels follow the list. Returns their number; where it is 0 nothing changes. Throws what find_elbows() and the
// scratch file throw.
std::size_t add_elbows(const PointCloud& cloud, const ElbowOptions& options, DetectReport& report);

}  // namespace pcm
