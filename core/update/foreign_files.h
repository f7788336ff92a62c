// Data files of another tree in a tree's folder: found by what is in them, never removed, replaced or read as the
// tree's.
#pragma once

#include "pcm/tree/tree_index.h"
#include "pcm/update/chunk_scan.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace pcm {

// The files with the names of the tree's next data files (a number from `data_files` on) that no interrupted update of
// this tree has left: their first chunk is of another tree, of a generation that the tree has already had, or of no
// tree. Throws Error(io | permission).
std::vector<std::filesystem::path> foreign_data_files(const std::filesystem::path& folder, const TreeInfo& info,
                                                      std::size_t data_files);

// For a repair, with the data files scanned, and the index and about.pct where they can be read. Where a needed data
// file is another tree's, points are lost that the tree's own file has, wherever that is now; without an index the tree
// could even become the other one. Only the user knows which is right: throws Error(corrupt), naming the file and what
// to do.
void refuse_foreign_files(const std::filesystem::path& folder, const std::vector<FoundFile>& files,
                          const std::optional<TreeIndex>& index, const std::optional<TreeInfo>& about);

}  // namespace pcm
