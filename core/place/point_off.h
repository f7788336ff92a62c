// Whether the point that was picked belongs to another surface than the shape found there.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/place/fit_at.h"

namespace pcm {

// Doubts a good shape that the point nearest to the place is far off (place.off_place), or a curved one that it is off
// and others of the nearest points are, too; planes have edges that were looked at (other_answers.h). `limit`: no other
// points are looked at. Throws what points_near() throws.
void doubt_point_off(const PointCloud& cloud, const Vec3d& place, const Selection& limit, FittedPrimitive& found);

}  // namespace pcm
