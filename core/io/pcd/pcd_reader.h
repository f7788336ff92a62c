// Reads the points of PCD files: versions .5, .6 and .7; ascii, binary, binary_compressed.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

// Positions are doubles, exactly as stored (position_type says whether they were f32), wherever x y z are in a record.
// A packed colour, one value of 4 bytes, becomes "rgb" u8 x 3; a field "rgba" also gives "alpha" u8. red green blue
// (also r g b) become "rgb" x 3 and normal_x/y/z (also nx ny nz) "normal" x 3, if the three have the same type. Every
// other field is an attribute with its own type, name and number of components; "_" is padding. Comments of pcd_writer
// restore scale and offset of attributes, unusual names and metadata. VIEWPOINT is metadata "pcd.viewpoint", with its
// words unchanged: like PCL, this reader does not transform the points by it.
//
// Files that are too short for their points are refused here; for ascii and damaged compressed ones, read() throws.
// Memory is a few megabytes whatever the size of the compressed block. NaN and infinities are kept: in organised clouds
// they mark points without a measurement.
std::unique_ptr<PointReader> open_pcd(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
