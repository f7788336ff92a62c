// Metadata as text for people.
#pragma once

#include "pcm/io/reader.h"

#include <string>

namespace pcm {

// Text blocks unchanged (a coordinate system as WKT, a comment), the keys of a GeoTIFF directory as "ProjectedCSType
// 26917, ..."; empty for other binary blocks. Control characters become blanks.
std::string text_of(const Metadata& block);

}  // namespace pcm
