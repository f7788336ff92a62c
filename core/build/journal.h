// A file of records that survives a crash: opened again, it has the records that were written completely.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

// Record: u32 kind, u32 0, u64 bytes, u64 checksum of these fields and of the bytes; then the bytes. The file is
// truncated before the first invalid record. One thread at a time.
class Journal {
public:
    struct Record {
        std::uint32_t kind = 0;
        std::vector<std::byte> bytes;
    };

    // Opens the journal, or creates an empty one. Throws Error(permission | no_space | io).
    explicit Journal(const std::filesystem::path& path);

    const std::vector<Record>& records() const { return records_; }  // found when it was opened
    // Removes the records found from number `from` on, in memory and in the file.
    void cut(std::size_t from);
    void forget_found() { std::vector<Record>().swap(records_); }  // in memory only
    // The record is on disk when this returns.
    void append(std::uint32_t kind, const std::vector<std::byte>& bytes);

private:
    void truncate(std::uint64_t end);
    File file_;
    std::vector<Record> records_;
    std::vector<std::uint64_t> starts_;  // offsets of the records found
    std::uint64_t end_ = 0;
};

}  // namespace pcm
