// Constants of the chunk layout that encoder and decoder share; FORMAT.md has the layout.
#pragma once

#include "pcm/bpc/chunk_identity.h"
#include "pcm/cloud/attribute.h"

#include <cstddef>
#include <cstdint>

namespace pcm::bpc_layout {

inline constexpr char magic[4] = {'B', 'P', 'C', '1'};
inline constexpr std::uint16_t version_on_grid = 1;
inline constexpr std::uint16_t version_of_doubles = 2;
inline constexpr std::uint16_t version_of_trees = 3;
inline constexpr std::size_t header_bytes_at = 24;
inline constexpr std::size_t total_bytes_at = 32;
inline constexpr std::size_t fixed_header = 164;  // the shortest of the versions, without its checksum
// A header has some hundred bytes or some kilobytes; the limit keeps a damaged file from filling the memory.
inline constexpr std::uint32_t most_header_bytes = std::uint32_t{16} << 20;
// Equal points take no bytes in a file, but they do in memory.
inline constexpr std::uint64_t most_decoded_bytes = std::uint64_t{1} << 32;
inline std::uint64_t decoded_bytes(std::uint64_t points, bool wide, const Schema& schema)
{
    return points * ((wide ? 24 : 12) + schema.point_bytes());
}

// Bits of what a chunk of version 3 has.
inline constexpr std::uint32_t has_wide_positions = 1, has_sizes = 2;

// How a column of version 3 is stored.
inline constexpr std::uint8_t in_segments = 0;
inline constexpr std::uint8_t constant = 1;

// A description of what is wrong with an identity; null when it is valid.
inline const char* wrong_with(const ChunkIdentity& identity)
{
    if (identity.path.depth > NodePath::max_depth) return "a node deeper than the longest path";
    for (std::uint16_t word = 0; word < 2; ++word) {
        const int used = int(identity.path.depth) - 64 * word;
        const std::uint64_t beyond = used >= 64 ? 0 : used <= 0 ? ~std::uint64_t(0) : ~std::uint64_t(0) << used;
        if (identity.path.bits[word] & beyond) return "a path that continues below its node";
    }
    if (identity.generation == 0) return "a generation 0";
    if (identity.first_level + identity.level_points.size() > 256) return "points of level 256 or finer";
    if (!(identity.spacing >= 0)) return "no spacing";
    return nullptr;
}

}  // namespace pcm::bpc_layout
