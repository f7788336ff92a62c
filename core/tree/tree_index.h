// The index file of a tree folder, as bytes; the layout is in bpc/FORMAT.md.
#pragma once

#include "pcm/system/byte_source.h"
#include "pcm/tree/index_head.h"
#include "pcm/tree/tree.h"

#include <memory>
#include <string>
#include <vector>

namespace pcm {

std::string data_file_name(std::uint32_t number);  // "chunks-000.bpc"

// An index as a whole, in memory: for writers, and for changes that touch every node.
struct TreeIndex {
    TreeInfo info;
    std::vector<Node> nodes;
    std::vector<NodeId> part_roots{0};  // no_node for a part without points; empty for a tree without nodes
    std::vector<DataFile> data_files;
    // The number of nodes of each page. Where they are not those of `nodes`, encode_index() divides the nodes itself.
    std::vector<std::uint32_t> pages;
};

// Ends a generation: appends its commit record to the bytes in use of the index's last data file, and counts the record
// as in use. The file must exist.
void write_commit(const std::filesystem::path& folder, TreeIndex& index);

// Nodes are written with the parts that follow from the roots of the parts, whatever Node::part says. A page holds as
// many whole subtrees of node_order.h as fit.
std::vector<std::byte> encode_index(const TreeIndex& index);

// The levels of a tree with these nodes; a level beyond `spacings` is left out.
std::vector<LevelSummary> summaries_of_levels(const std::vector<Node>& nodes, const std::vector<double>& spacings);

// The bytes of an index file. Throws Error(not_a_tree | unsupported | corrupt) for a file that is not an
// index or is longer than its own counts allow, before memory is taken for it, and Error(io).
std::vector<std::byte> read_index(const ByteSource& file);

// Decodes version 4 and version 3. Checks magic, version, checksums and every invariant that tree.h states for nodes.
// Throws Error(not_a_tree | corrupt | unsupported).
TreeIndex decode_index(const std::vector<std::byte>& bytes, const std::filesystem::path& path);

// An index whose nodes come page by page.
struct OpenIndex {
    std::shared_ptr<const IndexHead> head;
    NodeTable nodes;
};
// At most three reads: the beginning of the file, the rest of a long head, the first page; an index of version 3 is
// read as a whole. The file stays open while pages are missing. Throws what read_index() and decode_index() throw.
OpenIndex open_index(std::shared_ptr<const ByteSource> file);
OpenIndex in_memory(TreeIndex index);

}  // namespace pcm
