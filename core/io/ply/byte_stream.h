// Consecutive bytes of a file, for records whose place must be found by reading: vertices with lists.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// One thread. The file must outlive the stream. Buffers 1 MB, whatever the length of the file.
class ByteStream {
public:
    ByteStream(const File& file, std::uint64_t start, std::uint64_t file_size)
        : file_(file), position_(start), file_size_(file_size)
    {
    }

    std::uint64_t position() const { return position_; }
    std::uint64_t left() const { return file_size_ - position_; }

    // Both throw Error(truncated), naming the byte, when the file has fewer bytes left.
    void skip(std::uint64_t bytes);
    void take(std::byte* to, std::size_t bytes);

private:
    void need(std::uint64_t bytes) const;

    const File& file_;
    std::uint64_t position_;
    std::uint64_t file_size_;
    std::uint64_t buffer_start_ = 0;
    std::vector<std::byte> buffer_;
};

}  // namespace pcm
