// Where a surface is: points within the threshold of its mathematical continuation belong to it by chance alone.
#pragma once

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/working_points.h"

#include <vector>

namespace pcm {

// For each point within a threshold the part of such points around it that belong to the surface: 0 where they are no
// more than the points around, beyond the threshold, let expect by chance. A few such points far from the others, on
// the other side of a cylinder say, would weigh more in least squares than all others. One thread.
class LocalSupport {
public:
    LocalSupport(const ShapeModel& model, const WorkingPoints& points) : model_(model), points_(points) {}

    // `noise` is the standard deviation of the distances. False: these differ from those of the last shape by less than
    // half of it, and nothing changes.
    bool find(const Shape& shape, double threshold, double noise);
    const double* of_points() const
    {
        return support_.empty() ? nullptr : support_.data();
    }  // null: unknown, few points

private:
    const ShapeModel& model_;
    const WorkingPoints& points_;
    std::vector<double> distances_, support_;
    double size_ = 0;
};

}  // namespace pcm
