// Writes PTS, Leica's text format: a line with the number of points, then one line per point.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

// A line is "x y z", "x y z intensity", or "x y z intensity r g b" with colours 0..255, depending on the cloud's
// attributes; with colours but no intensities, the intensity is 0. The first line is the count, padded with blanks to
// 20 characters. Coordinates: see TextOutput::put_position.
//
// notes() reports differences from the cloud: attributes that PTS cannot store, colours that were rounded (16-bit ones
// are exact when they are multiples of 257, floats when they are multiples of 1/255), and intensities that are not
// integers from -2048 to 2047, the range of PTS; these are written unchanged.
std::unique_ptr<PointWriter> create_pts(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

}  // namespace pcm
