// Well-known text of coordinate systems, versions 1 and 2 (OGC 01-009, 12-063r5, 18-010).
#pragma once

#include "pcm/io/crs/coordinate_system.h"

#include <optional>
#include <string_view>

namespace pcm {

// Name, code, kind and units of a projected, geographic, geocentric, local or compound system; of a bound system those
// of its source. Nothing for text that is not WKT of a coordinate system.
std::optional<CoordinateSystem> decode_wkt(std::string_view text);

// The text without blanks outside of quotes, keywords in upper case: equal for texts that differ only in layout.
std::string compact_wkt(std::string_view text);

}  // namespace pcm
