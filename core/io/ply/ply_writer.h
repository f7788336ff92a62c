// Writes PLY: binary little endian, or ascii with WriteOptions.ascii.
#pragma once

#include "pcm/io/survey.h"
#include "pcm/io/writer.h"

namespace pcm {

// x y z are float for sources in single precision, bit for bit, otherwise double. Gridded positions are written as
// their coordinates and stay doubles when read back: read as integers, a file would have to be refused after another
// program moved a single point. The grid's scale and offset are kept as metadata "pcm.grid", "sx sy sz ox oy oz".
//
// Attributes keep their types, with these exceptions, which ply_reader undoes:
// - Attributes with a scale or an offset are written as their values: integers as floats, or doubles where floats would
//   not name every integer; reals as doubles, next to their raw numbers (NAME_raw).
// - "rgb" has 8 bits in red green blue, which other programs show: where 8 bits hold every colour that is all;
// otherwise
//   they are rounded, and red_exact green_exact blue_exact have the cloud's. WriteOptions::colour_bits chooses one of
//   them.
// - PLY has no 64-bit integers. They are doubles when options.survey says that all are within +-2^53, otherwise two of
// 32
//   bits each, NAME_low and NAME_high.
// - A float "intensity" next to colours is scalar_intensity, as in CloudCompare: MeshLab takes `intensity` for the
// colour. "normal" is nx ny nz; "alpha", "radius", "intensity" and others keep their names; components are name_0,
// name_1, ... Names that PLY does not allow, scale and offset, and metadata are stored in comments, from which
// ply_reader restores them.
std::unique_ptr<PointWriter> create_ply(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

SurveyQuestions ply_questions(const FileInfo& cloud, const WriteOptions& options);

}  // namespace pcm
