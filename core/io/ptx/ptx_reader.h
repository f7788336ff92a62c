// Reads PTX, Leica's text format: consecutive scans, each on a grid of directions, with a transform to world
// coordinates.
#pragma once

#include "pcm/io/reader.h"

#include <filesystem>
#include <memory>

namespace pcm {

// A scan has two lines with the numbers of columns and rows, one with the scanner's position, three with its axes, four
// with a 4x4 transform, and columns x rows lines "x y z intensity" or "x y z intensity r g b".
//
// Positions are (x y z 1) * M in double, with the lines of M as in the file: the translation is the last line, and the
// last column must be 0 0 0 1, else Error(bad_format) names the line. Lines
// with x y z = 0 0 0 are directions without a return: they are dropped and counted in info().notes. Intensities are
// floats, colours rgb. With several scans, or in files of more than 128 MB, which are not searched for further scans,
// the attribute "scan" counts them from 1. Metadata "ptx.scan/<n>" is the text of the ten lines before scan n. Notes
// and metadata are complete when the file has been read; info().points is the number that the scans state.
//
// A scan that ends too early is Error(truncated), naming the line, the points found and the number stated. With
// options.skip_bad_lines, lines of points that cannot be read are counted; those of headers never.
std::unique_ptr<PointReader> open_ptx(const std::filesystem::path& path, const ReadOptions& options = {});

// Whether a file begins like PTX: two lines of one whole number and lines of 3 3 3 3 4 4 4 4 numbers.
bool looks_like_ptx(const std::filesystem::path& path);

}  // namespace pcm
