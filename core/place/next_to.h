// The points next to a set of points.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/query/point_set.h"
#include "pcm/select/point_scan.h"
#include "pcm/system/progress.h"

namespace pcm {

// Those for which the test holds and that the limit chooses, in cubes of edge `way` (source units, above 0) that have
// points of the set, and in the cubes around these: all within `way` of the set, none farther than 3.5 times that.
// Where the cubes would be more than a quarter of a million they are twice as wide, and so on. Streams. Throws what
// scan_points() throws.
PointSet points_next_to(const PointSet& points, double way, const PlaceTest& test, const Selection& limit,
                        unsigned threads = 0, const ProgressFunction& progress = {});

}  // namespace pcm
