// Writes PTS, Leica's text format: a line with the number of points, then a line a point.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

// A line is "x y z", "x y z intensity", or "x y z intensity r g b" with colours 0..255, by what the cloud has; colours
// without intensities get an intensity of 0. The first line is the count and blanks up to 20 characters. Coordinates:
// see TextOutput::put_position.
//
// notes() tells what is not the cloud's own: attributes that PTS has no place for, colours that had to be rounded
// (those of 16 bits are exact when they are multiples of 257, floats when they are of 255 steps), intensities that are
// not integers from -2048 to 2047, which is what PTS means by them; they are written as they are.
std::unique_ptr<PointWriter> create_pts(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

}  // namespace pcm
