// The index file of a tree folder, as bytes; the layout is in bpc/FORMAT.md.
#pragma once

#include "tree/tree.h"

#include <string>
#include <vector>

namespace pcm {

inline constexpr const char* build_marker_name = "building";  // present while a folder is being built
std::string data_file_name(std::uint32_t number);             // "chunks-000.bpc"

struct TreeIndex {
    TreeInfo info;
    std::vector<Node> nodes;
    std::vector<std::uint64_t> data_file_bytes;  // live length of each data file
};

std::vector<std::byte> encode_index(const TreeIndex& index);

// Checks magic, version, checksum and every invariant that tree.h states for nodes. Throws Error(corrupt | unsupported).
TreeIndex decode_index(const std::vector<std::byte>& bytes, const std::filesystem::path& path);

}  // namespace pcm
