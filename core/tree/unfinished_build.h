// The names by which a build that is running or was interrupted is recognised. The folder NAME.part, next to the tree
// NAME that it will become, belongs to the build (build/build_folder.h).
#pragma once

#include "pcm/system/tree_folder.h"

#include <filesystem>

namespace pcm {

inline constexpr const char* replaced_tree_name = "old";  // in the folder of a build: the tree to be replaced

// NAME.part for the tree NAME.
std::filesystem::path build_folder_of(std::filesystem::path tree);

// Whether an interrupted build has moved the tree out of its place and nothing stands there now.
bool was_being_replaced(const std::filesystem::path& tree);

}  // namespace pcm
