// A file of a build's scratch data, and how much of that there is on disk.
#pragma once

#include "pcm/system/file.h"

#include <atomic>
#include <cstdint>
#include <filesystem>

namespace pcm {

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

// Grows at its end; what is not needed any more is given back to the file system as holes. Any thread.
class ScratchFile {
public:
    static constexpr std::uint64_t page = 4096;  // space is taken and given back in pages

    // A new file, in place of one that is there; or, to go on with, one that is there: what follows is appended.
    ScratchFile(const std::filesystem::path& path, ScratchSpace& space, bool go_on = false);
    ScratchFile(ScratchFile&&) = delete;
    ~ScratchFile();

    const std::filesystem::path& path() const { return file_.path(); }
    // The end of the file, which moves `bytes` on.
    std::uint64_t reserve(std::uint64_t bytes) { return end_.fetch_add(bytes); }
    std::uint64_t bytes() const { return end_; }
    // Tells that so much more, or less, of what was reserved lies on disk.
    void take(std::uint64_t bytes);
    void write_at(const void* from, std::size_t bytes, std::uint64_t offset) { file_.write_at(from, bytes, offset); }
    void read_at(void* to, std::size_t bytes, std::uint64_t offset) const { file_.read_at(to, bytes, offset); }
    void sync() { file_.sync(); }
    // Makes a hole; `bytes` of its pages are on disk. Where the file system knows no holes they stay there, and are
    // counted.
    void give_back(std::uint64_t offset, std::uint64_t length, std::uint64_t bytes);
    void clear();  // nothing in it is needed
    void remove();

private:
    File file_;
    ScratchSpace& space_;
    std::atomic<std::uint64_t> end_{0}, on_disk_{0};
};

}  // namespace pcm
