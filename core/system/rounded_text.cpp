#include "pcm/system/rounded_text.h"

#include "pcm/system/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace pcm {

std::string rounded_text(double value, double uncertainty)
{
    constexpr double most_decimals = 15;
    if (!(uncertainty > 0) || !std::isfinite(value) || value == 0) return exact(value);
    const double last = std::isinf(uncertainty) ? 1e-4 * std::fabs(value) : uncertainty;
    const int decimals = static_cast<int>(std::clamp(1 - std::floor(std::log10(last)), 0.0, most_decimals));
    char text[400];  // 309 digits before the point
    const std::string rounded(text,
                              std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr);
    const bool is_zero = rounded.find_first_not_of("-0.") == std::string::npos;
    return is_zero && rounded[0] == '-' ? rounded.substr(1) : rounded;
}

std::string rounded_text(const std::array<double, 3>& v, double uncertainty)
{
    return rounded_text(v[0], uncertainty) + " " + rounded_text(v[1], uncertainty) + " " +
           rounded_text(v[2], uncertainty);
}

}  // namespace pcm
