// A file of records that outlives a crash: whoever opens it again finds the records that were written as a whole.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

// Record: u32 kind, u32 0, u64 bytes, u64 checksum of what is before and of the bytes; then the bytes. What follows the
// first record that does not hold is cut off. One thread at a time.
class Journal {
public:
    struct Record {
        std::uint32_t kind = 0;
        std::vector<std::byte> bytes;
    };

    // Opens the journal, or makes an empty one. Throws Error(permission | no_space | io).
    explicit Journal(const std::filesystem::path& path);

    const std::vector<Record>& records() const { return records_; }  // that were found
    // Forgets what was found from record number `from` on, in the file too.
    void cut(std::size_t from);
    void forget_found() { std::vector<Record>().swap(records_); }  // in memory alone
    // The record is on disk when this returns.
    void append(std::uint32_t kind, const std::vector<std::byte>& bytes);

private:
    void truncate(std::uint64_t end);
    File file_;
    std::vector<Record> records_;
    std::vector<std::uint64_t> starts_;  // of the records found
    std::uint64_t end_ = 0;
};

}  // namespace pcm
