// Points as lines of text: .xyz .txt .asc .csv, and .pwn, points with normals. How lines are read: text/text_reader.h.
#pragma once

#include "pcm/io/reader.h"

#include <filesystem>
#include <memory>

namespace pcm {

// Columns are those that options.text names, those of a header, or guessed from the numbers.
std::unique_ptr<PointReader> open_xyz(const std::filesystem::path& path, const ReadOptions& options = {});

// The same, but a file that does not name its columns must have six: x y z nx ny nz. Throws Error(unsupported)
// otherwise.
std::unique_ptr<PointReader> open_pwn(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
