// The shape that fits the points about picked places best, where its kind is not known.
#pragma once

#include "pcm/primitives/fit_at.h"

#include <vector>

namespace pcm {

// Fits each of the kinds to the same points and keeps the one that explains them best: least sum of
// min(distance^2 / threshold^2, 1), to which a kind adds a fiftieth of the points for each number more than a plane
// takes, and a doubtful fit a tenth of them. So a plane is not taken for a large sphere. Only the one that is kept is
// followed through the cloud. `options.fit.kind` is not used; all kinds refused: the result of the first one. Throws
// Error(invalid_argument) without kinds, and what fit_at() throws.
FittedPrimitive fit_any_at(const PointCloud& cloud, const std::vector<Vec3d>& places,
                           const std::vector<Vec3d>& not_places, const std::vector<ShapeKind>& kinds,
                           const FitAtOptions& options);

// By which kinds are compared: the sum above, divided by the number of points. Infinite for a refused fit.
double unexplained(const ShapeFit& fit, std::size_t points);

}  // namespace pcm
