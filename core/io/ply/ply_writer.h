// Writes PLY: binary little endian, or ascii with WriteOptions.ascii.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

// x y z are float where the source's positions are, so bit for bit, else double: of a source on a grid the coordinates
// that the grid stands for. They stay doubles when read back: integers would mean to refuse a file of which some editor
// has moved a single point. The grid's scale and offset are kept as metadata "pcm.grid", "sx sy sz ox oy oz".
//
// Attributes keep their types. "rgb" is red green blue, "normal" nx ny nz, "alpha", "radius", "intensity" and others
// have their own names; components are name_0, name_1, ... PLY has no integers of 64 bits: each is two of 32,
// name_low and name_high. Names that a word of PLY cannot be, scale and offset, and metadata are carried in comments,
// which ply_reader turns back into what they were.
std::unique_ptr<PointWriter> create_ply(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

}  // namespace pcm
