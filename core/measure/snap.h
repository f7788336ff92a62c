// Points for measures: the nearest ones of a cloud, with what their uncertainty depends on.
#pragma once

#include "pcm/measure/measure.h"
#include "pcm/point_cloud.h"

namespace pcm {

struct SnappedPoint {
    MeasuredPoint point;
    double distance = 0;  // from the place that was asked for
};

// The cloud's point that is nearest to a place, at full resolution. Its spacing is the mean distance to its four
// nearest neighbours (fewer in a smaller cloud). Throws Error(invalid_argument) for a cloud without points, and what
// PointCloud::nearest() throws.
SnappedPoint snap(PointCloud& cloud, const Vec3d& place);

// The largest step of a grid.
double largest_step(const Grid& grid);

}  // namespace pcm
