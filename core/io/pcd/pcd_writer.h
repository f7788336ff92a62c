// Writes PCD .7: binary, or ascii with WriteOptions.ascii.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

// x y z are F 4 where the source's positions are single precision, so bit for bit, else F 8: of a source on a grid the
// coordinates that the grid stands for; its scale and offset are kept as metadata "pcm.grid", as in PLY. PCL's own
// point types want F 4, which is said in notes(): map coordinates would lose half a metre there.
//
// "rgb" of u8 x 3 is PCL's packed field `rgb` (`rgba` when "alpha" follows it), of another type red green blue;
// "normal" is normal_x normal_y normal_z; any other attribute is a field of its type with its components as COUNT.
// Names that a header cannot hold, scale and offset, and metadata are carried in comments, which pcd_reader turns back
// into what they were.
std::unique_ptr<PointWriter> create_pcd(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

}  // namespace pcm
