// A file descriptor that closes itself and turns every failure into pcm::Error.
//
// write_at may be called from any number of threads at once, as the reads of a ByteSource may.
#pragma once

#include "pcm/system/byte_source.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace pcm {

class File final : public ByteSource {
public:
    // Every mode refuses anything but a regular file (a FIFO, a device, a folder) without waiting for it. Only `read`
    // follows a symbolic link in the file's place: nothing is written through one.
    enum class Mode {
        read,
        create_new,          // no file may have the name
        create_or_truncate,  // a new file; one that has the name is removed, and keeps its bytes where it has other
                             // names
        change,              // reads and writes an existing file
        change_or_create,    // the same, or a new file
    };

    File() = default;
    File(const std::filesystem::path& path, Mode mode);
    // A file in the folder of `path` that has no name yet, so that nothing is left when the process ends; give_name()
    // gives it one. Not open where the file system has no such files. Errors name `path`.
    static File without_name(const std::filesystem::path& path);
    File(File&& other) noexcept;
    File& operator=(File&& other) noexcept;
    ~File() override;

    bool is_open() const { return descriptor_ >= 0; }
    const std::filesystem::path& path() const override { return path_; }
    int descriptor() const { return descriptor_; }
    std::uint64_t size() const override;
    std::size_t read_some_at(void* to, std::size_t bytes, std::uint64_t offset) const override;
    bool keeps_its_name() const override;

    // Advice to the system: reads take what they need in one piece, and what follows is not to be read ahead.
    void expect_scattered_reads() const;
    void write_at(const void* from, std::size_t bytes, std::uint64_t offset);
    void sync();
    // Gives a file without a name the name `path`. False when something has this name already. Throws
    // Error(unsupported) where the system cannot do that.
    bool give_name(const std::filesystem::path& path) const;
    // Closes, and throws for a write error that the system reports only now (the destructor closes silently).
    void close();

private:
    int descriptor_ = -1;
    std::filesystem::path path_;
};

// A folder that is held open: to sync it later needs no further file descriptor.
class OpenFolder {
public:
    explicit OpenFolder(const std::filesystem::path& folder);
    ~OpenFolder();
    OpenFolder(const OpenFolder&) = delete;
    OpenFolder& operator=(const OpenFolder&) = delete;
    // Makes renames and new names in the folder durable, where the file system can.
    void sync() const;

private:
    std::filesystem::path path_;
    int descriptor_;
};

void sync_folder(const std::filesystem::path& folder);

// The folder that `path` is in; "." for a bare name.
std::filesystem::path folder_holding(const std::filesystem::path& path);

// Renames atomically. Where the system reports a failure, but the file has its new name (network file systems do that),
// nothing is thrown. `action` is a phrase like "giving the tree its name".
void rename_path(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& action);

// Replaces a file atomically and durably: writes a temporary file next to it, syncs, renames it over `path`, and syncs
// the folder. After a failure or a crash `path` is the old file or the new one.
void replace_file(const std::filesystem::path& path, const void* bytes, std::size_t size);

}  // namespace pcm
