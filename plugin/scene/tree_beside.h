// The tree through which a large file is opened. It is next to the file or in a folder for trees, and built when the
// file is opened first.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/system/progress.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// NAME.las -> NAME.pct if `folder` is empty. Else NAME-HASH.pct in that folder; the hash of the file's absolute path
// distinguishes files of the same name from different folders.
std::filesystem::path tree_path(const std::filesystem::path& file, const std::filesystem::path& folder = {});

// Whether the tree at `tree` was built from `file` alone and is current: not older than the file, and with the same
// number of points if the file states it. False if there is no tree. Throws what Tree::open throws, except for an
// interrupted build (false).
bool tree_is_current(const std::filesystem::path& tree, const std::filesystem::path& file,
                     std::optional<std::uint64_t> file_points);

struct TreeBeside {
    std::filesystem::path file;
    std::filesystem::path tree;  // where it is or will be
    ReadOptions read;            // how the file is read
    bool rebuild = false;        // even if the tree is current: the user has specified how to read the file
};

// Builds the tree unless it exists and is current. Returns lines for the log. Throws Error(exists) if something else
// has the tree's name, Error(permission | not_found) if the folder cannot be written, and what build_tree throws.
std::vector<std::string> ensure_tree(const TreeBeside& wanted, const FileInfo& info, const ProgressFunction& progress);

}  // namespace pcm::host
