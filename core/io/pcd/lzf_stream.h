// Decompresses LZF, the format of Marc Lehmann's liblzf, from a file into bytes taken in order.
//
// A control byte c < 32 stands before c + 1 literal bytes. Any other stands for a copy of n + 2 bytes from d + 1 bytes
// back, where n is its upper three bits, plus the next byte when they are all set, and d its lower five bits times 256
// plus the byte that then follows. So 3 bytes become 264 at most, and nothing older than 8192 bytes is ever needed: a
// stream can stop and be copied anywhere, which a decoder of whole blocks in memory cannot.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

inline constexpr std::uint64_t lzf_most_expansion = 88;

// One thread. Takes some 48 kB. A copy goes on by itself from where the original is.
class LzfStream {
public:
    // The compressed bytes [begin, end) of the file, which must outlive the stream and its copies.
    LzfStream(const File& file, std::uint64_t begin, std::uint64_t end) : file_(&file), next_byte_(begin), end_(end) {}

    // The next `count` bytes; `to` may be null. Throws Error(corrupt), naming the byte of the file, when the compressed
    // bytes end before or refer to what was never there.
    void take(std::byte* to, std::uint64_t count);
    // Whether all compressed bytes are used up.
    bool at_end() const { return given_ == decoded_ && in_at_ == in_end_ && next_byte_ == end_; }

private:
    void decode_some();
    std::size_t decode_from_buffer(std::byte* out, std::size_t at);
    void refill();
    [[noreturn]] void fail(const char* what) const;
    std::uint64_t position() const { return next_byte_ - (in_end_ - in_at_); }  // in the file

    const File* file_;
    std::uint64_t next_byte_;  // of the file, not yet in in_
    std::uint64_t end_;
    std::vector<std::byte> in_;
    std::size_t in_at_ = 0, in_end_ = 0;  // of in_: what is unread
    std::vector<std::byte> out_;
    std::size_t decoded_ = 0;  // of out_: the last bytes, 8192 at least once there are as many
    std::size_t given_ = 0;    // of these
};

}  // namespace pcm
