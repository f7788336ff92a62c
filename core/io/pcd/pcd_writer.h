// Writes PCD .7: binary, or ascii with WriteOptions.ascii.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

// x y z are F 4 for sources in single precision, bit for bit, otherwise F 8. Gridded positions are written as their
// coordinates; scale and offset are kept as metadata "pcm.grid", as in PLY. PCL's own point types need F 4, which
// notes() say: with map coordinates these would lose half a metre.
//
// "rgb" of u8 x 3 is PCL's packed field `rgb` (`rgba` when "alpha" follows it); of another type it is red green blue.
// "normal" is normal_x normal_y normal_z. Any other attribute is a field of its type with its components as COUNT.
// Names that a header cannot hold, scale and offset, and metadata are stored in comments, from which pcd_reader
// restores them.
std::unique_ptr<PointWriter> create_pcd(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

}  // namespace pcm
