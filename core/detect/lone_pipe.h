// Which cylinders are pipes, where normals of points show nothing of them.
#pragma once

#include "pcm/detect/shape_growth.h"

#include <vector>

namespace pcm {

// The largest threshold up to `most` that does not hide the bend of these points of a cylinder
// (detect.search.sagitta_thresholds); source units.
double visible_threshold(const Shape& shape, const std::vector<Vec3d>& points, double most);

// Whether the cylinder is longer than wide, nearly all of its points turn by `turn` (radians) and have a bend that its
// threshold does not hide, and it is alone: few other free points are within a few thresholds of its surface
// (PipeTuning).
bool is_lone_pipe(const SurfaceSample& sample, const ShapeGrowth& growth, const FoundShape& pipe, double turn);

}  // namespace pcm
