// What is known of the sides of a unit's normals, as bytes.
#pragma once

#include "pcm/bpc/byte_order.h"
#include "pcm/filter/orientation_propagation.h"

#include <cstddef>
#include <vector>

namespace pcm {

// Without UnitOrientation::piece, which is a column of the unit's points.
std::vector<std::byte> bytes_of(const UnitOrientation& unit);
UnitOrientation orientation_of(const std::vector<std::byte>& bytes, const std::filesystem::path& path);

}  // namespace pcm
