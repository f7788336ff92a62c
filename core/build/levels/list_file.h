// The file in which sampling keeps what it has chosen: lists of indices, and a byte for each point of a bin.
#pragma once

#include "pcm/system/file.h"

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <vector>

namespace pcm {

// Grows at its end. Any thread.
class ListFile {
public:
    // A list's place, and the checksum of its bytes.
    struct Place {
        std::uint64_t offset = 0;
        std::uint32_t count = 0;
        std::uint64_t checksum = 0;
    };

    // With Mode::create_new the file is removed in the end, otherwise it stays.
    ListFile(const std::filesystem::path& path, File::Mode mode);
    ~ListFile();

    const std::filesystem::path& path() const { return file_.path(); }
    std::uint64_t bytes() const { return end_; }
    // For a file that was there: its end, in bytes. Returns whether the file is that long.
    bool reopen(std::uint64_t bytes);
    void sync() { file_.sync(); }

    Place write(const std::vector<std::uint32_t>& indices);
    std::uint64_t write(const std::vector<std::uint8_t>& bytes);  // returns the offset
    // Throws scratch_changed() where the bytes are not those that were written.
    std::vector<std::uint32_t> read(const Place& place) const;
    std::vector<std::uint8_t> read(std::uint64_t offset, std::size_t count) const;

private:
    std::uint64_t append(const void* data, std::size_t bytes);

    File file_;
    const bool remove_;
    std::mutex mutex_;
    std::uint64_t end_ = 0;
};

}  // namespace pcm
