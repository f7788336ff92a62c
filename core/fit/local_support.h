// Where a surface is: points within the threshold of its mathematical continuation belong to it by chance alone.
#pragma once

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/working_points.h"

#include <vector>

namespace pcm {

// For each point within the threshold the part of such points around it that belong to the surface: 0 where they are no
// more than the points around, beyond the threshold, let expect by chance. A few such points far from the others, on
// the other side of a cylinder say, would weigh more in least squares than all others. Empty: too few points to say.
std::vector<double> local_support(const ShapeModel& model, const Shape& shape, const WorkingPoints& points,
                                  double threshold);

}  // namespace pcm
