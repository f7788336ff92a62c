// Whether the point that was picked belongs to another surface than the shape found there.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/place/fit_at.h"

namespace pcm {

// Doubts a good curved shape that the point nearest to the place leaves by more than the noise, where several of the
// nearest points are beyond its threshold (place.point_off). One point alone may be noise: of those under the pointer a
// window picks the nearest to the viewer. `limit`: no other points are looked at. Throws what points_near() throws.
void doubt_point_off(const PointCloud& cloud, const Vec3d& place, const Selection& limit, FittedPrimitive& found);

// Doubts a good shape that this point and several of the nearest ones leave to the same side, by more than independent
// errors do at one place in fifty, even where the point that was picked is the outermost of those under the
// pointer; by more than the threshold where neighbours share errors (found.agreement, without what shifts of stations
// explain).
void doubt_point_aside(const PointCloud& cloud, const Vec3d& place, const Selection& limit, FittedPrimitive& found);

}  // namespace pcm
