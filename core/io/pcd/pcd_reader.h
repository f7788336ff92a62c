// Reads the points of PCD files: versions .5, .6 and .7; ascii, binary, binary_compressed.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

// Positions are doubles, exactly as stored (position_type tells whether they were f32), wherever x y z stand in a
// record. A packed colour, one value of 4 bytes, is "rgb" u8 x 3, of a field "rgba" with "alpha" u8; red green blue
// (also r g b) become "rgb" x 3 and normal_x/y/z (also nx ny nz) "normal" x 3 where the three have one type. Every
// other field is an attribute in its own type, name and number of components; "_" is padding. Comments of pcd_writer
// give back scale and offset of attributes, odd names and metadata. VIEWPOINT is metadata "pcd.viewpoint", its words as
// they stand there: like PCL itself, this does not move the points by it.
//
// Files that are too short for their points are refused here, ascii and damaged compressed ones when read() gets there.
// Memory stays below some megabytes whatever the size of the compressed block. NaN and infinities are passed on: points
// of organised clouds where the sensor saw nothing.
std::unique_ptr<PointReader> open_pcd(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
