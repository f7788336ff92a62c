// A page of an index file: some nodes, as bytes. The layout is in bpc/FORMAT.md.
#pragma once

#include "pcm/tree/node.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

class ByteReader;
struct NodePage;

inline constexpr std::size_t node_bytes = 116;  // bytes of one node, without the counts of its levels
inline constexpr std::size_t node_bytes_without_part = node_bytes - sizeof(std::uint32_t);  // the same in version 3

// The nodes [first, first + count) of a vector, with their parts from another one.
std::vector<std::byte> encode_page(const std::vector<Node>& nodes, const std::vector<std::uint32_t>& parts,
                                   std::size_t first, std::size_t count);

// The bytes of a page. Throws Error(corrupt) when they do not have its checksum, or are not those of its nodes, with at
// most `levels` levels each. What the nodes say is not checked: node_checks.h.
std::vector<Node> decode_page(const NodePage& page, const std::byte* bytes, std::uint32_t levels,
                              const std::filesystem::path& path);

// Nodes one after another, then the points of their levels; without parts in an index of version 3. Throws the same.
std::vector<Node> get_nodes(ByteReader& in, std::uint32_t count, std::uint32_t levels, bool have_parts,
                            const std::filesystem::path& path);

}  // namespace pcm
