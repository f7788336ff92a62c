// Units of coordinate systems.
#pragma once

#include "pcm/io/crs/coordinate_system.h"

namespace pcm {

// By EPSG code: 9001 metre, 9002 foot, 9003 US survey foot, ..., 9102 degree. Unknown codes give an unknown unit.
CrsUnit unit_of_code(unsigned code);
// With the usual name of a unit of this size, else with `name`.
CrsUnit linear_unit(std::string_view name, double metres);
CrsUnit angular_unit(std::string_view name, double radians);
// Both are known and their sizes differ by more than rounding in decimal text.
bool differ(const CrsUnit& a, const CrsUnit& b);

}  // namespace pcm
