// The head of an index file: everything but the nodes, and where the pages of nodes lie. The layout is in
// bpc/FORMAT.md.
#pragma once

#include "pcm/system/byte_source.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

inline constexpr std::uint32_t index_version = 4, index_version_without_pages = 3;
inline constexpr std::uint32_t most_nodes_of_page = 1 << 16;

struct NodePage {
    NodeId first = 0;  // its first node
    std::uint32_t nodes = 0;
    std::uint64_t offset = 0, bytes = 0;  // in the index file
    std::uint64_t checksum = 0;
};

struct IndexHead {
    TreeInfo info;
    std::vector<DataFile> data_files;
    std::vector<NodeId> part_roots;
    std::vector<LevelSummary> levels;
    std::uint32_t nodes = 0;
    std::vector<NodePage> pages;
    std::uint64_t file_bytes = 0;  // size of the index file, as it follows from the pages
};

std::vector<std::byte> encode_head(const IndexHead& head);

// The first bytes of an index file: the head, and in most cases the first page. One read.
std::vector<std::byte> read_beginning(const ByteSource& file);

// The version, 3 or index_version, that these bytes state. Throws Error(not_a_tree | unsupported), and Error(corrupt)
// where everything else is of a version that can be read.
std::uint32_t version_of_index(const std::vector<std::byte>& beginning, const std::filesystem::path& path);

// The head of a file of index_version that begins with these bytes; reads on where the head is longer. Throws
// Error(corrupt | io); memory is taken for what the file holds at most.
IndexHead read_head(const ByteSource& file, std::vector<std::byte>& beginning);

// The same for the bytes of a whole index file.
IndexHead decode_head(const std::vector<std::byte>& bytes, const std::filesystem::path& path);

}  // namespace pcm
