// Metadata in words, where they have some.
#pragma once

#include "pcm/io/reader.h"

#include <string>

namespace pcm {

// What a block says, for people: text as it is (a coordinate system as WKT, a comment), the keys of a GeoTIFF directory
// as "ProjectedCSType 26917, ..."; empty for other binary blocks. Control characters become blanks.
std::string text_of(const Metadata& block);

}  // namespace pcm
