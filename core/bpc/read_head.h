// Reading the first bytes of a chunk, and errors that name the file and the byte.
#pragma once

#include "pcm/system/error.h"
#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// The first bytes of a chunk, including its whole header. The first read takes `guess` bytes.
std::vector<std::byte> read_head(const File& file, std::uint64_t offset, std::uint64_t available, std::size_t guess);

// For errors that were found in the chunk's bytes and name no file: adds the file and the chunk's offset. To be called
// while `error` is being handled.
[[noreturn]] void rethrow_naming(const Error& error, const File& file, std::uint64_t offset);

}  // namespace pcm
