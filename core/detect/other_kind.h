// Whether a doubtful shape is a piece of one that bends more: a cone's side is nearly a cylinder or a plane.
#pragma once

#include "pcm/fit/shape_fit.h"

#include <optional>
#include <vector>

namespace pcm {

// The kind that explains points better than `fit` does, with evidence for its additional parameters (choose_kind()):
// cones in place of planes and cylinders, cylinders in place of planes, which are no wider than those of better_kind().
// In place of spheres cylinders and tori, by the points on both: a sphere lies along a band of either. Nothing where
// there is none. `points`: some of those of the fit, source coordinates. Points within the fit's threshold of the other
// shape count. One thread; some milliseconds for 500 points.
std::optional<ShapeKind> other_kind(const ShapeFit& fit, const std::vector<Vec3d>& points);

}  // namespace pcm
