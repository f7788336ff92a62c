// Points of a set that are enough to find what it covers.
#pragma once

#include "pcm/query/point_set.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/progress.h"

#include <cstddef>
#include <vector>

namespace pcm {

// All points of the set, in source coordinates. If there are more than `most`, only the points of the coarse levels
// that have no more than `most` together, or of the coarsest one, and from each node the points that are farthest along
// the shape's axis and in 64 directions across it. Streams; memory: the points. The result depends neither on threads
// nor on their order. Throws Error(cancelled), and what reading throws.
std::vector<Vec3d> cover_points(const PointSet& set, const Shape& shape, unsigned threads = 0,
                                const ProgressFunction& progress = {}, std::size_t most = 1000000);

// All points of the set. If there are more than `most`, only the points of the coarse levels that have no more than
// `most` together, or of the coarsest one: they are spread evenly. Otherwise as cover_points(). Points that represent a
// cell may lie on one side of their surface, by as much as its noise.
std::vector<Vec3d> coarse_points(const PointSet& set, std::size_t most, unsigned threads = 0,
                                 const ProgressFunction& progress = {});

// All points of the set. If there are more than `most`, a random sample of about `most` points, the same one in each
// call, which is on both sides of the surface as all points are. Otherwise as cover_points().
std::vector<Vec3d> random_points(const PointSet& set, std::size_t most, unsigned threads = 0,
                                 const ProgressFunction& progress = {});

}  // namespace pcm
