// The index file of a tree folder, as bytes; the layout is in bpc/FORMAT.md.
#pragma once

#include "pcm/system/file.h"
#include "pcm/tree/tree.h"

#include <string>
#include <vector>

namespace pcm {

std::string data_file_name(std::uint32_t number);  // "chunks-000.bpc"

struct TreeIndex {
    TreeInfo info;
    std::vector<Node> nodes;
    std::vector<NodeId> part_roots{0};  // no_node for a part without points; empty for a tree without nodes
    std::vector<DataFile> data_files;
};

// Ends a generation: appends its commit record to the bytes in use of the index's last data file, and counts the record
// as in use. The file must exist.
void write_commit(const std::filesystem::path& folder, TreeIndex& index);

std::vector<std::byte> encode_index(const TreeIndex& index);

// Sets the part of each node, given the roots of the parts. Throws Error(corrupt) when a node with points belongs to no
// part or to two.
void find_parts(TreeIndex& index, const std::filesystem::path& path);

// The bytes of an index file. Throws Error(not_a_tree | unsupported | corrupt) for a file that is not an index or is
// longer than its own counts allow, before memory is taken for it, and Error(io).
std::vector<std::byte> read_index(const File& file);

// Checks magic, version, checksum and every invariant that tree.h states for nodes. Throws Error(not_a_tree | corrupt |
// unsupported).
TreeIndex decode_index(const std::vector<std::byte>& bytes, const std::filesystem::path& path);

}  // namespace pcm
