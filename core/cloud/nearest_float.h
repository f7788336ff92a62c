// Rounding to single precision.
#pragma once

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

}  // namespace pcm
