// Planes that are one level of a sensor's depths: a depth camera measures multiples of a step that grows with the
// distance, up to several centimetres, so that whatever it sees is cut into flat patches without any noise.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/place/near_points.h"
#include "pcm/point_cloud.h"
#include "pcm/shapes/primitive.h"

#include <vector>

namespace pcm {

// Places of levels along the plane's normal, relative to it, ascending, where nearly all points lie on two or more that
// are parallel to it: patches, not the rows of points on the side of a box. `noise`: one standard deviation of the
// plane's points. Empty where there are no such levels, or the plane is none of them.
std::vector<double> level_heights(const NearPoints& near, const Shape& plane, double noise);

// Doubts a plane with far less noise than its points are apart if most places along its outline show levels, three or
// more in all, and adds to its errors that the surface may be anywhere within a level. Other shapes, and planes without
// an outline, stay. Reads some thousand points. Throws what points_near() throws.
void doubt_level(const PointCloud& cloud, const Selection& limit, Primitive& primitive);

}  // namespace pcm
