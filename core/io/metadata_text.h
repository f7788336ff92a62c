// Metadata as text for people.
#pragma once

#include "pcm/io/reader.h"

#include <string>
#include <vector>

namespace pcm {

// Text blocks unchanged (a coordinate system as WKT, a comment), the keys of a GeoTIFF directory as "ProjectedCSType
// 26917, ..."; empty for other binary blocks. Control characters become blanks.
std::string text_of(const Metadata& block);

// A note for writers: which blocks of the cloud `format` has no place for, "TEXT has no place for metadata, which are
// not written: las.vlr/...". Empty when nothing is lost but a LAS header, a grid, or the crs comment itself. A block
// that `is_written` is not named.
std::string unwritten_note(const std::string& format, const std::vector<Metadata>& metadata,
                           bool (*is_written)(const Metadata&) = nullptr);

}  // namespace pcm
