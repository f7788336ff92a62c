// Surfaces of second degree over a plane: height = a + b x + c y + d x^2 + e x y + f y^2.
#pragma once

#include <cstddef>

namespace pcm {

inline constexpr std::size_t surface_numbers = 6;  // a to f

}  // namespace pcm
