// A file written from beginning to end that appears under its name only when it is complete.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

namespace pcm {

// One thread. Until finish() the bytes are in a file without a name, so that a process that is killed leaves nothing.
// Where the file system has no such files, they are in NAME.part-PROCESS-NUMBER next to `path`, which is locked; the
// destructor removes it, and those of processes that were killed are removed by the next OutputFile of the same path.
// finish() syncs the file and atomically replaces the file that has the name; where the name is a symbolic link, the
// file that it leads to. Several files that are put in place together: output_group.h. Throws Error(no_space |
// permission | not_found | io), and what output_file() (output_path.h) throws for a name that is not written to.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::uint64_t size() const { return written_ + buffer_.size(); }

    void append(const void* bytes, std::size_t count);
    void append(std::string_view text) { append(text.data(), text.size()); }
    // Appends `count` bytes for the caller to fill before the next call: for encoding in place.
    std::byte* extend(std::size_t count);
    // Replaces bytes appended before: a header whose counts are known at the end. Throws Error(invalid_argument) beyond
    // the end.
    void rewrite(const void* bytes, std::size_t count, std::uint64_t offset);
    // Throws an Error that is_done() when the file is complete and in place, but may not survive a loss of power.
    void finish();
    // The same at once, also while there is an OutputGroup, after `condition` was asked as the last thing before the
    // file gets its name. Where it is false, the name keeps the file that it has, and this returns false.
    bool finish_if(const std::function<bool()>& condition);

private:
    void flush();
    void complete();
    void put_in_place();

    std::filesystem::path path_, place_;  // as given; where the file is put
    std::filesystem::path part_;          // the file's present name; empty while it has none
    File file_;
    std::vector<std::byte> buffer_;
    std::uint64_t written_ = 0;
    bool finished_ = false;
};

}  // namespace pcm
