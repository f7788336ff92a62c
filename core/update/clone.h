// A second tree of the same points, in moments.
#pragma once

#include <filesystem>

namespace pcm {

// Makes the tree `output` out of `tree`. Its data files are the same files under second names (hard links) where the
// file system has such, copies elsewhere; as no data file is ever written again, what is done to one tree does not show
// in the other. The output appears when it is whole; on an error what was written is removed. Throws Error(exists) when
// there is something of that name, and what Tree::open and the file system throw.
void clone_tree(const std::filesystem::path& tree, const std::filesystem::path& output);

}  // namespace pcm
