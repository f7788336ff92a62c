// The pages of an E57 file: each has 1020 bytes of content and a checksum.
//
// Physical offsets count all bytes of the file, logical ones only the content. ASTM E2807-11, 9.2.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

// CRC-32C (Castagnoli), reflected, polynomial 0x1EDC6F41.
std::uint32_t crc32c(const std::byte* bytes, std::size_t count);

// One thread.
class E57Pages {
public:
    static constexpr std::size_t page_bytes = 1024;
    static constexpr std::size_t content_bytes = page_bytes - 4;

    // Throws what opening can throw, and Error(truncated) for a size that is not a multiple of the page size.
    explicit E57Pages(const std::filesystem::path& path);

    const File& file() const { return file_; }
    std::uint64_t physical_size() const { return pages_ * page_bytes; }
    std::uint64_t logical_size() const { return pages_ * content_bytes; }

    // Logical offset for a physical one; the logical size for an offset in a checksum or outside of the file.
    std::uint64_t to_logical(std::uint64_t physical) const;
    static std::uint64_t to_physical(std::uint64_t logical)
    {
        return logical / content_bytes * page_bytes + logical % content_bytes;
    }

    // Throws Error(truncated) where the file has fewer bytes, Error(corrupt) for a wrong checksum of a page; only
    // pages that are read are checked.
    void read(void* to, std::size_t bytes, std::uint64_t logical);

private:
    const std::byte* content_of(std::uint64_t page);

    File file_;
    std::uint64_t pages_ = 0;
    std::uint64_t first_in_buffer_ = 0;  // page
    std::vector<std::byte> buffer_;
    std::vector<bool> checked_;  // for each page of the buffer
};

}  // namespace pcm
