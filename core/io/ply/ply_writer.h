// Writes PLY: binary little endian, or ascii with WriteOptions.ascii.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

// x y z are float for sources in single precision, bit for bit, otherwise double. Gridded positions are written as
// their coordinates and stay doubles when read back: read as integers, a file would have to be refused after another
// program moved a single point. The grid's scale and offset are kept as metadata "pcm.grid", "sx sy sz ox oy oz".
//
// Attributes keep their types. "rgb" is red green blue, "normal" nx ny nz; "alpha", "radius", "intensity" and others
// keep their names; components are name_0, name_1, ... PLY has no 64-bit integers: each is written as two of 32 bits,
// name_low and name_high. Names that PLY does not allow, scale and offset, and metadata are stored in comments, from
// which ply_reader restores them.
std::unique_ptr<PointWriter> create_ply(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

}  // namespace pcm
