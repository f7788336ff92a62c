// Reads PTS, Leica's text format: a line with the number of points, then one line per point. How lines are read:
// text/text_reader.h.
#pragma once

#include "pcm/io/reader.h"

#include <filesystem>
#include <memory>

namespace pcm {

// The first three columns are x y z; then intensity with 4, colours with 6, both with 7 columns. Intensities are i16
// where they are whole numbers that fit, as Leica writes them (-2048..2047).
std::unique_ptr<PointReader> open_pts(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
