#include "pcm/bpc/read_head.h"

#include "pcm/bpc/layout.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {

std::vector<std::byte> read_head(const File& file, std::uint64_t offset, std::uint64_t available, std::size_t guess)
{
    std::vector<std::byte> head(static_cast<std::size_t>(std::min<std::uint64_t>(available, guess)));
    file.read_at(head.data(), head.size(), offset);
    if (head.size() >= 28 && std::memcmp(head.data(), bpc_layout::magic, 4) == 0) {
        std::uint32_t header_bytes;
        std::memcpy(&header_bytes, head.data() + bpc_layout::header_bytes_at, 4);
        if (header_bytes > head.size() && header_bytes <= available && header_bytes <= bpc_layout::most_header_bytes) {
            const std::size_t have = head.size();
            head.resize(header_bytes);
            file.read_at(head.data() + have, header_bytes - have, offset + have);
        }
    }
    return head;
}

[[noreturn]] void rethrow_naming(const Error& error, const File& file, std::uint64_t offset)
{
    if (!error.path().empty()) throw;
    throw Error(error.code(), file.path(), "chunk at byte " + std::to_string(offset) + ": " + error.what());
}

}  // namespace pcm
