// The files of a tree and the system's cache of them: what makes a run cold or warm, and what the disk gives.
#pragma once

#include <cstdint>
#include <filesystem>

namespace pcm::bench {

struct Reading {
    std::uint64_t bytes = 0;
    double seconds = 0;
    double megabytes_a_second() const { return seconds > 0 ? static_cast<double>(bytes) / 1e6 / seconds : 0; }
};

// Writes what is dirty and forgets what the system has cached of the tree's files. Throws std::runtime_error.
void drop_from_cache(const std::filesystem::path& tree);

// Share of the files' pages that the system holds in memory, 0 to 1. After drop_from_cache() it shows whether that was
// done.
double share_in_cache(const std::filesystem::path& tree);

// Reads every file once, a megabyte at a time, and looks at nothing.
Reading read_files(const std::filesystem::path& tree);

// The same past the system's cache, four megabytes at a time; nothing read when the file system cannot do that.
Reading read_files_direct(const std::filesystem::path& tree);

}  // namespace pcm::bench
