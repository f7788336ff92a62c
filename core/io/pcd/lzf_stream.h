// Decompresses LZF, the format of Marc Lehmann's liblzf, as a stream from a file.
//
// A control byte c < 32 is followed by c + 1 literal bytes. Any other means a copy of n + 2 bytes from d + 1 bytes
// back, where n is its upper three bits, plus the next byte when they are all set, and d its lower five bits times 256
// plus the byte that follows. So 3 bytes become 264 at most, and no reference goes back more than 8192 bytes: a stream
// can stop and be copied anywhere, unlike a decoder of whole blocks in memory.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

inline constexpr std::uint64_t lzf_most_expansion = 88;

// One thread. Takes some 48 kB. A copy continues independently from the position of the original.
class LzfStream {
public:
    // The compressed bytes [begin, end) of the file, which must outlive the stream and its copies.
    LzfStream(const File& file, std::uint64_t begin, std::uint64_t end) : file_(&file), next_byte_(begin), end_(end) {}

    // The next `count` bytes; `to` may be null. Throws Error(corrupt), naming the byte of the file, when the compressed
    // bytes end too early or a reference goes back beyond their start.
    void take(std::byte* to, std::uint64_t count);
    // Whether all compressed bytes have been used.
    bool at_end() const { return given_ == decoded_ && in_at_ == in_end_ && next_byte_ == end_; }

private:
    void decode_some();
    std::size_t decode_from_buffer(std::byte* out, std::size_t at);
    void refill();
    [[noreturn]] void fail(const char* what) const;
    std::uint64_t position() const { return next_byte_ - (in_end_ - in_at_); }  // in the file

    const File* file_;
    std::uint64_t next_byte_;  // offset in the file of the first byte not yet in in_
    std::uint64_t end_;
    std::vector<std::byte> in_;
    std::size_t in_at_ = 0, in_end_ = 0;  // the unread part of in_
    std::vector<std::byte> out_;
    std::size_t decoded_ = 0;  // bytes in out_: the most recent ones, at least 8192 after the first 8192
    std::size_t given_ = 0;    // bytes of out_ already returned
};

}  // namespace pcm
