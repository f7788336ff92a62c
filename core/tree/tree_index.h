// The index file of a tree folder, as bytes; the layout is in bpc/FORMAT.md.
#pragma once

#include "pcm/tree/tree.h"

#include <string>
#include <vector>

namespace pcm {

std::string data_file_name(std::uint32_t number);  // "chunks-000.bpc"

struct TreeIndex {
    TreeInfo info;
    std::vector<Node> nodes;
    std::vector<NodeId> part_roots{0};  // no_node for a part without points; {} for a tree without nodes
    std::vector<DataFile> data_files;
};

// Ends a generation: puts its commit record behind the live bytes of the index's last data file, which then count it.
// The file must exist.
void write_commit(const std::filesystem::path& folder, TreeIndex& index);

std::vector<std::byte> encode_index(const TreeIndex& index);

// Gives each node its part, from the parts' roots. Throws Error(corrupt) when a node with points is of no part, or of
// two.
void find_parts(TreeIndex& index, const std::filesystem::path& path);

// Checks magic, version, checksum and every invariant that tree.h states for nodes. Throws Error(corrupt |
// unsupported).
TreeIndex decode_index(const std::vector<std::byte>& bytes, const std::filesystem::path& path);

}  // namespace pcm
