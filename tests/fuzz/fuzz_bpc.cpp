#include "pcm/bpc/checksum.h"
#include "pcm/io/bpc/bpc_reader.h"
#include "tests/fuzz/reader_input.h"
#include "tests/fuzz/seal_tree_chunk.h"

#include <cstring>
#include <vector>

namespace {

template <class T>
T number(const std::vector<std::uint8_t>& bytes, std::size_t at)
{
    T value;
    std::memcpy(&value, &bytes[at], sizeof value);
    return value;
}

void seal(std::vector<std::uint8_t>& bytes, std::size_t from, std::uint64_t size, std::uint64_t at)
{
    if (from > bytes.size() || size > bytes.size() - from || at > bytes.size() || bytes.size() - at < 8) return;
    const std::uint64_t sum = pcm::checksum(&bytes[from], static_cast<std::size_t>(size));
    std::memcpy(&bytes[static_cast<std::size_t>(at)], &sum, 8);
}

// Corrects the checksums: otherwise the fuzzer would never reach the code after their check.
void seal_all(std::vector<std::uint8_t>& bytes)
{
    std::size_t at = 0;
    std::uint64_t end = bytes.size();
    if (bytes.size() >= 48 && std::memcmp(bytes.data(), "BPCLOUD\n", 8) == 0) {
        const auto size = number<std::uint64_t>(bytes, 16);
        end = number<std::uint64_t>(bytes, 40);
        if (size < 8 || size > bytes.size()) return;
        seal(bytes, 0, size - 8, size - 8);
        if (end <= bytes.size() - 8)
            seal(bytes, static_cast<std::size_t>(end), bytes.size() - 8 - end, bytes.size() - 8);
        at = static_cast<std::size_t>(size);
    }
    // Columns first, because the header holds their checksums: the first column, and the last one, at the end of the
    // header.
    while (at < end && bytes.size() - at >= 44) {
        if (std::memcmp(&bytes[at], "BPCG", 4) == 0 || number<std::uint16_t>(bytes, at + 4) == 3) {
            const std::uint64_t size = pcm::fuzz::seal_record_of_tree(bytes, at);
            if (size == 0 || size > bytes.size() - at) return;
            at += static_cast<std::size_t>(size);
            continue;
        }
        if (bytes.size() - at < 176) return;
        const auto header = number<std::uint32_t>(bytes, at + 24);
        const auto total = number<std::uint64_t>(bytes, at + 32);
        if (header < 176 || header > bytes.size() - at) return;
        for (const std::size_t column : {std::size_t{144}, std::size_t{header} - 32}) {
            const auto offset = number<std::uint64_t>(bytes, at + column);
            if (offset < bytes.size())
                seal(bytes, at + static_cast<std::size_t>(offset), number<std::uint64_t>(bytes, at + column + 8),
                     at + column + 16);
        }
        seal(bytes, at, header - 8, at + header - 8);
        if (total < header || total > bytes.size() - at) return;
        at += static_cast<std::size_t>(total);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    std::vector<std::uint8_t> sealed(bytes, bytes + size);
    seal_all(sealed);
    pcm::fuzz::read_all(pcm::open_bpc, sealed.data(), sealed.size());
    return 0;
}
