// A large file is opened by way of a tree beside it, or in a folder for trees, which the first opening builds.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/io/reader.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// NAME.las -> NAME.pct, when `folder` is empty. Else in that folder, NAME-HASH.pct: the hash, of the file's absolute
// path with its extension, tells apart files of one name from several folders.
std::filesystem::path tree_path(const std::filesystem::path& file, const std::filesystem::path& folder = {});

// Whether the tree at `tree` was built of `file` alone, and of the file as it is now: not older than it, and with as
// many points where the file tells how many it has. False when there is no tree. Throws what Tree::open throws, except
// for a build that was interrupted (false).
bool tree_is_current(const std::filesystem::path& tree, const std::filesystem::path& file,
                     std::optional<std::uint64_t> file_points);

struct TreeBeside {
    std::filesystem::path file;
    std::filesystem::path tree;  // where it is or will be
    ReadOptions read;            // how the file is read
    bool anew = false;           // build also when there is a current tree: the user has said how to read the file
};

// Builds the tree unless a current one is there. Returns lines for the log. Throws Error(exists) when something else
// has the tree's name, Error(permission | not_found) when the folder cannot be written, and what build_tree throws.
std::vector<std::string> ensure_tree(const TreeBeside& wanted, const FileInfo& info, const ProgressFunction& progress);

}  // namespace pcm::host
