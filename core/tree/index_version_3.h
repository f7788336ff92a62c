// The index of trees that were built before indexes had pages (version 3): read as a whole, written no more.
#pragma once

#include "pcm/system/byte_source.h"
#include "pcm/tree/tree_index.h"

namespace pcm {

// The bytes of the file. Throws Error(corrupt) for a file that is longer than its own counts allow, before memory is
// taken for it, and Error(io).
std::vector<std::byte> read_index_of_version_3(const ByteSource& file);

// Throws Error(corrupt). Nodes are not checked, and have no parts yet.
TreeIndex decode_index_of_version_3(const std::vector<std::byte>& bytes, const std::filesystem::path& path);

}  // namespace pcm
