// A primitive where a rigid motion of its cloud puts it.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/shapes/primitive.h"

#include <array>
#include <optional>

namespace pcm {

// The rotation next to a matrix (rows) that differs from one by no more than single precision leaves, 1e-5 in any of
// its products; nothing for one that scales, shears or mirrors.
std::optional<std::array<Vec3d, 3>> rotation_of(const std::array<Vec3d, 3>& linear);

// Shape and bounds moved by the map, with rotation_of() in place of its matrix; all else as it is, as a motion leaves
// radii, residuals and standard deviations. Throws Error(invalid_argument), naming the primitive, for a map that is not
// rigid, and for numbers that are not finite. Any thread.
Primitive moved(Primitive primitive, const Affine& map);

}  // namespace pcm
