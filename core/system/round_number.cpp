#include "pcm/system/round_number.h"

#include <cmath>
#include <cstdlib>
#include <string>

namespace pcm {

double round_number(double value)
{
    if (!(value >= 1e-300 && value <= 1e300)) return value;
    const int exponent = static_cast<int>(std::floor(std::log10(value)));
    double best = value, least = HUGE_VAL;
    for (int e = exponent - 1; e <= exponent + 1; ++e)
        for (const char* const digit : {"1", "2", "5"}) {
            // As text reads: 0.2 and not 2 * 0.1.
            const double number = std::strtod((digit + ("e" + std::to_string(e))).c_str(), nullptr);
            const double apart = std::fabs(std::log(number / value));
            if (!(apart < least)) continue;
            least = apart;
            best = number;
        }
    return best;
}

}  // namespace pcm
