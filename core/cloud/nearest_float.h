// Rounding to single precision.
#pragma once

#include "pcm/cloud/vector.h"

namespace pcm {

// The float nearest to `value`, as a double. Any thread.
//
// The volatile is a workaround: GCC 12 at -O2 and above vectorises such conversions of three or six neighbouring
// doubles and forgets those that do not fill a vector (z, and the upper corner of a box, keep their double).
inline double nearest_float(double value)
{
    const volatile float rounded = static_cast<float>(value);
    return static_cast<double>(rounded);
}

// The same for each coordinate: the positions that readers get of a tree of floats.
inline Vec3d nearest_float(const Vec3d& p) { return {nearest_float(p[0]), nearest_float(p[1]), nearest_float(p[2])}; }

}  // namespace pcm
