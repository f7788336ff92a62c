// Paths as users type them into the parameters of filters, and the tree that a filter works on.
#pragma once

#include "plugin/scene/parameters.h"
#include "plugin/scene/scene.h"

#include <filesystem>
#include <vector>

namespace pcm::host {

// Relative ones start at the current folder.
std::filesystem::path absolute_path(const QString& text);
std::vector<std::filesystem::path> split_paths(const QString& text);  // separated by semicolons

// The folder that the parameter "Tree" names; where it is empty, the tree of the current layer. Throws
// Error(invalid_argument) if that layer shows none.
std::filesystem::path tree_of(const Parameters& parameters, const Scene& scene);

// `path` with the extension of trees. Throws Error(invalid_argument) for the name of a file of points, unless it is a
// folder's.
std::filesystem::path as_tree(std::filesystem::path path);

}  // namespace pcm::host
