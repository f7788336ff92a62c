// Whether the point that was picked belongs to another surface than the shape found there.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/place/fit_at.h"

namespace pcm {

// Doubts a good shape that the point nearest to the place is off, and others of the nearest points are, too
// (place.point_off). A plane only where it is beyond the threshold: planes have edges that were looked at
// (other_answers.h), and one point alone may be noise: of those under the pointer a window picks the nearest to the
// viewer. `limit`: no other points are looked at. Throws what points_near() throws.
void doubt_point_off(const PointCloud& cloud, const Vec3d& place, const Selection& limit, FittedPrimitive& found);

}  // namespace pcm
