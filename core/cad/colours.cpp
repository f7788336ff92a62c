#include "pcm/cad/colours.h"

#include <algorithm>
#include <cmath>

namespace pcm {

// 10 to 249 are 24 hues in steps of 15 degrees, each in five brightnesses, pure and half pale.
Rgb indexed_colour(int index)
{
    static const std::array<Rgb, 10> first{{{0, 0, 0},
                                            {255, 0, 0},
                                            {255, 255, 0},
                                            {0, 255, 0},
                                            {0, 255, 255},
                                            {0, 0, 255},
                                            {255, 0, 255},
                                            {255, 255, 255},
                                            {128, 128, 128},
                                            {192, 192, 192}}};
    static const std::array<std::uint8_t, 6> greys{51, 80, 105, 130, 190, 255};
    static const std::array<double, 5> brightness{255, 165, 127, 76, 38};
    const auto i = static_cast<std::size_t>(std::clamp(index, 0, 255));
    if (i < first.size()) return first[i];
    if (i >= 250) return {greys[i - 250], greys[i - 250], greys[i - 250]};
    const double hue = static_cast<double>((i - 10) / 10) / 4;  // sixths of the circle
    const double value = brightness[(i % 10) / 2], pale = i % 2 ? 0.5 : 0;
    Rgb colour{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double away = std::fabs(std::remainder(hue - 2 * static_cast<double>(a), 6));
        const double part = std::clamp(2 - away, 0.0, 1.0);
        colour[a] = static_cast<std::uint8_t>(value * (part + (1 - part) * pale));
    }
    return colour;
}

int nearest_colour_index(const Rgb& colour)
{
    int best = 1;
    double least = 1e9;
    for (int index = 1; index <= 255; ++index) {
        const Rgb other = indexed_colour(index);
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a) sum += std::pow(double{1} * colour[a] - other[a], 2);
        if (sum < least) {
            least = sum;
            best = index;
        }
    }
    return best;
}

}  // namespace pcm
