// Where a surface is: points within the threshold of its mathematical continuation belong to it by chance alone.
#pragma once

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/working_points.h"

#include <vector>

namespace pcm {

// Which points within a threshold exceed chance, as estimated from those around, beyond the threshold. A few others
// far away, e.g. across a cylinder, would weigh more in least squares than all of the surface. One thread.
class LocalSupport {
public:
    LocalSupport(const ShapeModel& model, const WorkingPoints& points) : model_(model), points_(points) {}

    // `noise` is the standard deviation of the distances. False: these differ from those of the last shape by less than
    // half of it, and nothing changes.
    bool find(const Shape& shape, double threshold, double noise);
    // 1 or 0 for each point; null: all, or too few points to judge.
    const double* of_points() const { return support_.empty() ? nullptr : support_.data(); }
    double share() const { return share_; }  // share of the points with 1 that are not near by chance

private:
    const ShapeModel& model_;
    const WorkingPoints& points_;
    std::vector<double> distances_, support_;
    double size_ = 0, share_ = 1;
};

}  // namespace pcm
