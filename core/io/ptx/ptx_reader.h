// Leica's PTX: scans one behind the other, each on a grid of directions and with a transform into the world.
#pragma once

#include "pcm/io/reader.h"

#include <filesystem>
#include <memory>

namespace pcm {

// A scan is two lines with the numbers of columns and rows, one with the scanner's position, three with its axes, four
// with a 4x4 transform, and columns x rows lines "x y z intensity" or "x y z intensity r g b".
//
// Positions are (x y z 1) * M in double, M as its lines stand there: the translation is the last line. Lines with x y z
// = 0 0 0 are directions without a return: they are dropped and counted in info().notes. Intensities are floats,
// colours rgb. Where there is more than one scan, or the file is larger than a look at all of it is worth (128 MB), the
// attribute "scan" counts them from 1. Metadata "ptx.scan/<n>" is the text of the ten lines before scan n. Notes and
// metadata are complete when all is read; so is the number of points: info().points is what the scans promise.
//
// A scan that ends before its last line is Error(truncated), naming the line, what was found and promised.
std::unique_ptr<PointReader> open_ptx(const std::filesystem::path& path, const ReadOptions& options = {});

// Whether a file begins like a PTX: two whole numbers and lines of 3 3 3 3 4 4 4 4 numbers.
bool looks_like_ptx(const std::filesystem::path& path);

}  // namespace pcm
