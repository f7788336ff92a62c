// Numbers for people, with the digits that are known of them.
#pragma once

#include <array>
#include <string>

namespace pcm {

// With one digit more than the uncertainty (of the value's unit) leaves, and no exponent: "0.06485" for 0.0005. All
// digits where the uncertainty is 0 or NaN, six where it is infinite.
std::string rounded_text(double value, double uncertainty);
std::string rounded_text(const std::array<double, 3>& v, double uncertainty);  // "x y z"

}  // namespace pcm
