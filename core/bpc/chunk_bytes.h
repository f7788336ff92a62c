// The bytes of one chunk of a file, read in as few reads as the caller's knowledge allows; and errors that name the
// file and the byte.
#pragma once

#include "pcm/system/byte_source.h"
#include "pcm/system/error.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace pcm {

// Bytes with at most this many others between them are read together: on a local disk that is faster than a second
// read.
inline constexpr std::uint64_t join_gap = 16384;

// One thread at a time.
class ChunkBytes {
public:
    // The chunk at `offset`, of which `available` bytes can be read. Reads `at_first` bytes of it now, and the rest of
    // its header where that is longer. Throws Error(truncated | io).
    ChunkBytes(const ByteSource& file, std::uint64_t offset, std::uint64_t available, std::uint64_t at_first);
    // A whole chunk that was read before, followed by codec_slack readable bytes. `bytes` must outlive this object.
    ChunkBytes(const std::byte* bytes, std::uint64_t size) : beginning_(bytes), beginning_size_(size) {}

    // What was read at first: the whole header, and maybe more.
    const std::byte* beginning() const { return beginning_; }
    std::uint64_t beginning_size() const { return beginning_size_; }

    // `bytes` bytes at `start` of the chunk, followed by codec_slack readable bytes; only what was not read before is
    // read. Valid until the next call. Throws Error(truncated | io).
    const std::byte* get(std::uint64_t start, std::uint64_t bytes);

private:
    const ByteSource* file_ = nullptr;
    std::uint64_t offset_ = 0;
    std::unique_ptr<std::byte[]> head_, more_;
    const std::byte* beginning_ = nullptr;
    std::uint64_t beginning_size_ = 0, more_size_ = 0;
};

// For errors that were found in the chunk's bytes and name no file: adds the file and the chunk's offset. To be called
// while `error` is being handled.
[[noreturn]] void rethrow_naming(const Error& error, const ByteSource& file, std::uint64_t offset);

}  // namespace pcm
