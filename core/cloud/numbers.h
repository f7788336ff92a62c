// Numbers that several sources name.
#pragma once

#include "pcm/cloud/vector.h"

#include <limits>

namespace pcm {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double unit_roundoff =
    std::numeric_limits<double>::epsilon() / 2;  // the largest relative error of one rounding
inline constexpr double degree = pi / 180;       // radians

inline double square(double v) { return v * v; }

}  // namespace pcm
