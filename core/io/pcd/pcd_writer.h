// Writes PCD .7: binary, or ascii with WriteOptions.ascii.
#pragma once

#include "pcm/io/survey.h"
#include "pcm/io/writer.h"

namespace pcm {

// x y z are F 4, which is what PCL's point types and Open3D read (doubles they take for zeros): bit for bit for sources
// in single precision, and where options.survey says that floats hold all positions, so that pcd_reader finds the
// points of the cloud's grid again. Otherwise they are F 8, and a note names the readers that cannot use them.
// WriteOptions::float_positions makes them F 4 relative to a whole-numbered shift, which is in VIEWPOINT and in a
// comment; pcd_reader adds it. position_error() is then the largest rounding. The scale and offset of gridded positions
// are kept as metadata "pcm.grid", as in PLY.
//
// "rgb" is PCL's packed field `rgb` of 8 bits (`rgba` when "alpha" of u8 follows it): where 8 bits hold every colour
// that is all; otherwise they are rounded, and `rgb_exact` has the cloud's. WriteOptions::colour_bits chooses one of
// them; 16 is red green blue. "intensity" and "normal" (normal_x normal_y normal_z) are floats, as in PCL's points;
// where floats are not exact, NAME_exact has the cloud's numbers. Any other attribute is a field of its type with its
// components as COUNT; one with a scale or an offset is written as its values, as in PLY. Names that a header cannot
// hold, scale and offset, and metadata are stored in comments, from which pcd_reader restores them.
std::unique_ptr<PointWriter> create_pcd(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

SurveyQuestions pcd_questions(const FileInfo& cloud, const WriteOptions& options);

}  // namespace pcm
