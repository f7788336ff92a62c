// Parses what stands at the beginning of a file before memory is taken for the whole file.
#pragma once

#include "pcm/bpc/byte_order.h"
#include "pcm/system/byte_source.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace pcm {

inline constexpr std::uint64_t first_beginning_bytes = std::uint64_t(1) << 20;
inline constexpr std::uint64_t most_beginning_bytes = std::uint64_t(1) << 28;

// Calls parse(ByteReader&) with the beginning of the file, first with first_beginning_bytes of it and, as long as it
// throws Error(corrupt), with four times as many, up to most_beginning_bytes or the whole file. Returns what it
// returns, throws what it throws at last.
template <class Parse>
auto parse_beginning(const ByteSource& file, const Parse& parse)
{
    const std::uint64_t size = file.size();
    for (std::uint64_t bytes = first_beginning_bytes;; bytes *= 4) {
        std::vector<std::byte> beginning(static_cast<std::size_t>(std::min(bytes, size)));
        file.read_at(beginning.data(), beginning.size(), 0);
        ByteReader in(beginning.data(), beginning.size(), file.path());
        try {
            return parse(in);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::corrupt || bytes >= size || bytes >= most_beginning_bytes) throw;
        }
    }
}

}  // namespace pcm
