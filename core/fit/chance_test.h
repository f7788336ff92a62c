// Whether the points near a shape are more than chance puts there.
#pragma once

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/working_points.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// A contrario (Desolneux, Moisan, Morel 2000; thresholds: Moisan, Stival 2004): the expected number of shapes with this
// number of points within a threshold if as many points lay anywhere in their box. One thread; working units.
class ChanceTest {
public:
    explicit ChanceTest(const WorkingPoints& points);

    // Share of the box that is within the threshold.
    double share(const ShapeModel& model, const Shape& shape, double threshold) const;
    // Natural logarithm of about the number of such shapes; 0 where it is 1 or more.
    double log_alarms(const ShapeModel& model, double share, double inliers) const;
    // The threshold with the minimum expected number of such shapes, from `most` down.
    double best_threshold(const ShapeModel& model, const Shape& shape, double most) const;

private:
    const WorkingPoints& points_;
    std::vector<double> x_, y_, z_;  // places evenly in the box
};

}  // namespace pcm
