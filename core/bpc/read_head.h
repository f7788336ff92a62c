// The start of reading a chunk, and how its errors name where it lies.
#pragma once

#include "pcm/system/error.h"
#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// The first bytes of a chunk, its whole header among them; `guess` of them in a first read.
std::vector<std::byte> read_head(const File& file, std::uint64_t offset, std::uint64_t available, std::size_t guess);

// Errors from inside the chunk's bytes name no file: adds it, and where the chunk lies.
[[noreturn]] void rethrow_naming(const Error& error, const File& file, std::uint64_t offset);

}  // namespace pcm
