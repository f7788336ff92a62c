// The number that MeshLab's positions are made of: float, or double in PyMeshLab and other builds in double precision.
#pragma once

#include <array>
#include <type_traits>

namespace pcm::host {

using Scalar = MESHLAB_SCALAR;

// In double no origin is needed: MeshLab's coordinates are source coordinates.
inline constexpr bool in_double = std::is_same_v<Scalar, double>;

using ScalarPosition = std::array<Scalar, 3>;

}  // namespace pcm::host
