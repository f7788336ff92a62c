// Colours of drawings.
#pragma once

#include <array>
#include <cstdint>

namespace pcm {

using Rgb = std::array<std::uint8_t, 3>;

// A colour of AutoCAD's index, 1 to 255, as it is seen on a dark background.
Rgb indexed_colour(int index);
// The nearest one.
int nearest_colour_index(const Rgb& colour);

}  // namespace pcm
