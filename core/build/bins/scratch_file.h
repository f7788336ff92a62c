// A file of a build's scratch data, and the disk space of all of them.
#pragma once

#include "pcm/system/error.h"
#include "pcm/system/file.h"

#include <atomic>
#include <cstdint>
#include <filesystem>

namespace pcm {

// For bytes of a scratch file whose checksum is not the one that was recorded when they were written.
Error scratch_changed(const std::filesystem::path& path, std::uint64_t offset);

// Bytes of all scratch files of a build. Any thread.
class ScratchSpace {
public:
    void take(std::uint64_t bytes)
    {
        const std::uint64_t now = now_.fetch_add(bytes) + bytes;
        std::uint64_t peak = peak_;
        while (peak < now && !peak_.compare_exchange_weak(peak, now)) {
        }
    }
    void give_back(std::uint64_t bytes) { now_ -= bytes; }
    std::uint64_t peak() const { return peak_; }

private:
    std::atomic<std::uint64_t> now_{0}, peak_{0};
};

// Grows at its end; released ranges become holes of the file. Any thread.
class ScratchFile {
public:
    static constexpr std::uint64_t page = 4096;  // unit in which space is taken and released

    // A new file, which replaces an existing one; or, with `reopen`, an existing one, to which data are appended.
    ScratchFile(const std::filesystem::path& path, ScratchSpace& space, bool reopen = false);
    ScratchFile(ScratchFile&&) = delete;
    ~ScratchFile();

    const std::filesystem::path& path() const { return file_.path(); }
    // Returns the end of the file and moves it by `bytes`.
    std::uint64_t reserve(std::uint64_t bytes) { return end_.fetch_add(bytes); }
    std::uint64_t bytes() const { return end_; }
    // Counts bytes of the reserved ranges that are on disk from now on.
    void take(std::uint64_t bytes);
    void write_at(const void* from, std::size_t bytes, std::uint64_t offset) { file_.write_at(from, bytes, offset); }
    void read_at(void* to, std::size_t bytes, std::uint64_t offset) const { file_.read_at(to, bytes, offset); }
    void sync() { file_.sync(); }
    // Makes a hole; `bytes` of its pages are on disk. On a file system without holes they stay there and remain
    // counted.
    void give_back(std::uint64_t offset, std::uint64_t length, std::uint64_t bytes);
    void clear();  // makes the file empty
    void remove();

private:
    File file_;
    ScratchSpace& space_;
    std::atomic<std::uint64_t> end_{0}, on_disk_{0};
};

}  // namespace pcm
