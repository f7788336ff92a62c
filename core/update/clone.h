// Copies a tree quickly, with hard links.
#pragma once

#include <filesystem>

namespace pcm {

// Makes the tree `output` with the points of `tree`. Its data files are hard links to the same files where the file
// system supports them, else copies. Data files are never overwritten, so a change of one tree does not affect the
// other. The output appears when it is complete; after an error the written files are removed. Throws Error(exists)
// when `output` exists, and what Tree::open and the file system throw; an Error that is_done() as
// BuildFolder::publish() does.
void clone_tree(const std::filesystem::path& tree, const std::filesystem::path& output);

// The same into the empty folder `folder`, which is the caller's to publish or to remove.
void clone_into(const std::filesystem::path& tree, const std::filesystem::path& folder);

}  // namespace pcm
