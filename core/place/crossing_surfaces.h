// What the surfaces that cross a plane, or end on it, do to its fit where nearly all of its points lie next to them.
//
// A surface that leads away from a plane has as many points in each band 0..t, t..2t, 2t..3t and 3t..4t of distances to
// its side (t: the threshold). Those in the first band are among the plane's, and turn it; those in the others show how
// many they are, and where. On each side the band with the fewest points is taken: the other face of a plate, which
// does not cross the plane, is not in all of them.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/query/point_set.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/progress.h"

#include <optional>

namespace pcm {

struct PlaneWithoutCrossing {
    Shape shape;
    Vec3d middle;  // centre of the box around the points
};

// The plane of least squares of `points` without what crossing surfaces probably add to them: the points of those bands
// are subtracted from the normal equations, as many thresholds nearer to the plane. Nothing for other kinds, where
// there are none, and where the points left determine no plane. `shape`: fitted to the points, which are within
// `threshold` of it; `around`: those up to around_thresholds from it (grow_shape.h). Source units. Streams. Throws
// Error(cancelled), and what reading throws.
std::optional<PlaneWithoutCrossing> without_crossing(const PointSet& points, const PointSet& around, const Shape& shape,
                                                     double threshold, unsigned threads = 0,
                                                     const ProgressFunction& progress = {});

}  // namespace pcm
