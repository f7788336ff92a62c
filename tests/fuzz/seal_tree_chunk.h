// Corrects the checksums of a tree's chunk: otherwise a fuzzer would never reach the code after their check.
#pragma once

#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_header.h"
#include "pcm/system/error.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pcm::fuzz {

inline void put_sum(std::vector<std::uint8_t>& bytes, std::size_t from, std::size_t size, std::size_t at)
{
    const std::uint64_t sum = checksum(&bytes[from], size);
    std::memcpy(&bytes[at], &sum, 8);
}

// Seals a chunk of version 3 or a commit record at `at`, where at least 44 bytes remain. Returns its length; 0 when it
// is invalid.
inline std::uint64_t seal_record_of_tree(std::vector<std::uint8_t>& bytes, std::size_t at)
{
    const auto number = [&](std::size_t from, auto kind) {
        std::memcpy(&kind, &bytes[at + from], sizeof kind);
        return kind;
    };
    const std::size_t left = bytes.size() - at;
    if (std::memcmp(&bytes[at], "BPCG", 4) == 0) {
        const auto size = number(8, std::uint32_t());
        if (size < 52 || size > left) return 0;
        put_sum(bytes, at, size - 8, at + size - 8);
        return size;
    }
    const auto header_bytes = number(24, std::uint32_t());
    if (header_bytes < 172 || header_bytes > left) return 0;
    const auto seal_header = [&] { put_sum(bytes, at, header_bytes - 8, at + header_bytes - 8); };
    seal_header();
    try {
        // Columns must be where the layout places them.
        const BpcHeader header = decode_header(reinterpret_cast<const std::byte*>(&bytes[at]), left, {});
        if (!header.identity) return 0;
        std::size_t place =
            164 + 4 * header.identity->level_points.size() + header.segments.size() * (header.wide ? 48 : 24);
        const auto seal_pieces = [&](const BpcColumn& column) {
            for (const BpcPiece& piece : column.pieces) {
                if (piece.offset <= left && piece.bytes <= left - piece.offset)
                    put_sum(bytes, at + static_cast<std::size_t>(piece.offset), static_cast<std::size_t>(piece.bytes),
                            at + place + 4);
                place += 12;
            }
        };
        seal_pieces(header.positions);
        for (std::size_t i = 0; i < header.schema.size(); ++i) {
            place += 21;
            place += 4 + number(place, std::uint32_t());
            place += 4 + number(place, std::uint32_t()) + 1;
            place += 8 * header.attributes[i].constant.size();
            seal_pieces(header.attributes[i]);
        }
        if (header.sizes) {
            place += 1 + 8 * header.sizes->constant.size();
            seal_pieces(*header.sizes);
        }
        seal_header();
        return header.total_bytes;
    } catch (const Error&) {
        return 0;
    }
}

}  // namespace pcm::fuzz
