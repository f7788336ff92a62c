// A file descriptor that closes itself and turns every failure into pcm::Error.
//
// read_at and write_at may be called from any number of threads at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace pcm {

class File {
public:
    enum class Mode { read, create_new, create_or_truncate, change };  // change: a file that is there

    File() = default;
    File(const std::filesystem::path& path, Mode mode);
    File(File&& other) noexcept;
    File& operator=(File&& other) noexcept;
    ~File();

    bool is_open() const { return descriptor_ >= 0; }
    const std::filesystem::path& path() const { return path_; }
    int descriptor() const { return descriptor_; }
    std::uint64_t size() const;

    // All of `bytes`, or Error(truncated) when the file ends before.
    void read_at(void* to, std::size_t bytes, std::uint64_t offset) const;
    // As many bytes as there are, up to `bytes`.
    std::size_t read_some_at(void* to, std::size_t bytes, std::uint64_t offset) const;
    void write_at(const void* from, std::size_t bytes, std::uint64_t offset);
    void sync();
    // Closes and reports a failure that the system held back until now (the destructor closes silently).
    void close();

private:
    int descriptor_ = -1;
    std::filesystem::path path_;
};

// Makes a rename or a new name in `folder` durable.
void sync_folder(const std::filesystem::path& folder);

// Writes the whole file under a temporary name, syncs, and renames it over `path`: at any instant `path` is the old
// file or the new one.
void replace_file(const std::filesystem::path& path, const void* bytes, std::size_t size);

}  // namespace pcm
