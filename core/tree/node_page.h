// A page of an index file: some nodes, as bytes. The layout is in bpc/FORMAT.md.
#pragma once

#include "pcm/tree/node.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

inline constexpr std::size_t node_bytes = 116;  // bytes of one node, without the counts of its levels

// The nodes [first, first + count) of a vector.
std::vector<std::byte> encode_page(const std::vector<Node>& nodes, std::size_t first, std::size_t count);

// Throws Error(corrupt) when the bytes are not those of `count` nodes with at most `levels` levels each. What the nodes
// say is not checked: node_checks.h.
std::vector<Node> decode_page(const std::byte* bytes, std::size_t size, std::uint32_t count, std::uint32_t levels,
                              const std::filesystem::path& path);

}  // namespace pcm
