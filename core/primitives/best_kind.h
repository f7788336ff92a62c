// Which kind of shape points have, when several were fitted to them.
#pragma once

#include "pcm/fit/shape_fit.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

// The fit with the least
//
//     sum over points of min(d^2, t^2) / s^2  +  k ln(n)
//
// d a point's distance from the surface, t the largest threshold and s the least noise of the fits (at least t / 1e6),
// n the number of points, and k that of the shape's parameters (plane 3, sphere 4, cylinder 5, cone 6, torus 7): the
// Bayesian information criterion with outliers at t. Doubtful fits are considered only where none is good, and refused
// ones never. The place in the list; nothing where all are refused.
std::optional<std::size_t> best_of(const std::vector<ShapeFit>& fits, const FitPoints& points);

}  // namespace pcm
