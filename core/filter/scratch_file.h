// Files for what a filter does not hold in memory.
#pragma once

#include "pcm/system/file.h"

#include <filesystem>

namespace pcm {

// A new file without a name in a folder, or with one of an update's scratch files until it is open: nothing is left
// when the process ends. A tree's folder has to be locked for writing; any other is used as a folder for temporary
// files. Throws what creating a file throws.
File scratch_file(const std::filesystem::path& folder);

}  // namespace pcm
