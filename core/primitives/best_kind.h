// Which kind of shape points have, when several were fitted to them.
#pragma once

#include "pcm/fit/shape_fit.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

// Kinds have ranks: the plane; cylinder and sphere, which may be planes of wide radius; cone and torus, which may be
// cylinders. Within a rank the fit with the least sum of min(d^2, t^2) is taken, d a point's distance from the surface
// and t the largest threshold of the fits, over the points within t of any of them; and one of a higher rank only where
// it has less than half of that: errors of scanners are alike at neighbours, and a shape with more parameters can
// follow them. Distances below t / 1000 count as that. Doubtful fits are considered only where none is good, and
// refused ones never. The place in the list; nothing where all are refused.
std::optional<std::size_t> best_of(const std::vector<ShapeFit>& fits, const FitPoints& points);

}  // namespace pcm
