// Points as lines of text: .xyz .txt .asc .csv .pwn, and .pts, which is the same with a line that says how many.
#pragma once

#include "pcm/io/reader.h"

#include <filesystem>
#include <memory>

namespace pcm {

// What the columns are is detected (text_sample.h, text_columns.h) where options.text does not say it, and told in
// info().notes. Positions are doubles, the nearest to the text. Blank lines and lines that begin with # // or % are
// passed over; every other line must be a row: Error(bad_format) names the line, what it holds and what was expected.
// Where a header names the columns, lines may have more fields; they are counted in the notes, which are complete when
// all is read.
//
// A line that holds one whole number promises as many rows behind it; there may be several such lists. Fewer rows are
// Error(truncated), more are read and noted.
std::unique_ptr<PointReader> open_xyz(const std::filesystem::path& path, const ReadOptions& options = {});

// The first three columns are x y z; then intensity with 4, colours with 6, both with 7 columns. Intensities are i16
// where they are whole numbers that fit, as Leica writes them (-2048..2047).
std::unique_ptr<PointReader> open_pts(const std::filesystem::path& path, const ReadOptions& options = {});

// Whether a file without a telling name holds lines of points and nothing else, by a look at pieces of it.
bool looks_like_points(const std::filesystem::path& path);

}  // namespace pcm
