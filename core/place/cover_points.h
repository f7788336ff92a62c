// Points of a set that are enough to find what it covers.
#pragma once

#include "pcm/query/point_set.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/progress.h"

#include <cstddef>
#include <vector>

namespace pcm {

// All points of the set, in source coordinates; of more than `most` those of coarse levels, about so many, and of each
// node those that are farthest along the shape's axis and in 64 directions across it. Streams; memory: the points.
// The result depends neither on threads nor on their order. Throws Error(cancelled), and what reading throws.
std::vector<Vec3d> cover_points(const PointSet& set, const Shape& shape, unsigned threads = 0,
                                const ProgressFunction& progress = {}, std::size_t most = 1000000);

// All points of the set; of more than `most` those of the coarse levels with no more, or of the first level: as far
// apart everywhere. Otherwise as cover_points(). Points that represent a cell may lie on one side of their surface, by
// as much as its noise.
std::vector<Vec3d> coarse_points(const PointSet& set, std::size_t most, unsigned threads = 0,
                                 const ProgressFunction& progress = {});

// All points of the set; of more than `most` about so many, at random, the same each time: about their surface as all
// are. Otherwise as cover_points().
std::vector<Vec3d> random_points(const PointSet& set, std::size_t most, unsigned threads = 0,
                                 const ProgressFunction& progress = {});

}  // namespace pcm
