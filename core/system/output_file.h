// A file that is written from its beginning to its end, and appears under its name only when it is whole.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace pcm {

// One thread. Until finish() the bytes are in a temporary file beside `path`, which the destructor removes; finish()
// makes them durable and renames over whatever has the name. Throws Error(no_space | permission | not_found | io).
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
    // `count` bytes to be filled before the next call: for those who encode in place.
    std::byte* extend(std::size_t count);
    // Replaces bytes that are written already: a header whose counts are known at the end.
    void rewrite(const void* bytes, std::size_t count, std::uint64_t offset);
    void finish();

private:
    void flush();

    std::filesystem::path path_, part_;
    File file_;
    std::vector<std::byte> buffer_;
    std::uint64_t written_ = 0;
    bool finished_ = false;
};

}  // namespace pcm
