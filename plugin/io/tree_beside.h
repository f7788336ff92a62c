// A large file is opened by way of a tree beside it, which the first opening builds.
#pragma once

#include "cloud/progress.h"
#include "io/reader.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// NAME.las -> NAME.pct
std::filesystem::path tree_path_beside(const std::filesystem::path& file);

// Whether the tree at `tree` was built of `file` alone, and of the file as it is now; `file_points` where the file says how
// many it holds. False when there is no tree. Throws what Tree::open throws, except for a build that was interrupted (false).
bool tree_is_current(const std::filesystem::path& tree, const std::filesystem::path& file,
                     std::optional<std::uint64_t> file_points);

// Builds the tree beside `file` unless a current one is there. Returns lines for the log. Throws Error(exists) when
// something else has the tree's name, Error(permission) when the folder cannot be written, and what build_tree throws.
std::vector<std::string> ensure_tree_beside(const std::filesystem::path& file, const FileInfo& info,
                                            const ProgressFunction& progress);

}  // namespace pcm::host
