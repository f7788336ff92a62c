// The length of a line along points, and how it changes with them.
#pragma once

#include "pcm/measure/measure.h"

#include <vector>

namespace pcm {

struct LineLength {
    double value = 0;
    std::vector<Vec3d> gradient;  // derivatives of the value by the coordinates of each point
    double variance_apart = 0;    // variance from segments of length 0, which have no gradient
};

enum class Seen : std::uint8_t { in_space, in_plan };

// `closed`: with the segment from the last point to the first.
LineLength line_length(const std::vector<MeasuredPoint>& points, Seen seen, bool closed = false);

// The uncertainty of a number with this gradient: sqrt(sum(variance |gradient|^2) + apart).
double propagated(const std::vector<MeasuredPoint>& points, const std::vector<Vec3d>& gradient, double apart = 0);

}  // namespace pcm
