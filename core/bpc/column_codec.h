// Packs a sequence of integers in blocks of 128 values, each with its own base and bit width. Lossless.
//
// Blocks are stored either as differences from their smallest value (frame of reference) or as zigzag differences
// between consecutive values, whichever is smaller for the whole sequence. Low bits that are zero in all differences of
// a block are not stored. A sequence of one repeated value takes 16 bytes. Where a sequence has few values that lie far
// apart, as colours of 8 bits do that were stretched to 16, they are listed, and their places are packed so. The layout
// is in FORMAT.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

inline constexpr std::size_t codec_block = 128;

// Number of bytes that must be readable after the input of unpack().
inline constexpr std::size_t codec_slack = 16;

// Appends `count` values (count > 0) to `out`. Word is std::uint32_t or std::uint64_t.
template <class Word>
void pack(const Word* values, std::size_t count, std::vector<std::byte>& out);

// Reads `count` values from the `size` bytes at `data` and returns the number of bytes consumed. `data` must be
// followed by codec_slack readable bytes. Never reads or writes out of bounds, whatever the bytes are; throws
// Error(corrupt) naming `path` for bytes that pack() cannot have written.
template <class Word>
std::size_t unpack(const std::byte* data, std::size_t size, Word* values, std::size_t count,
                   const std::filesystem::path& path);

extern template void pack(const std::uint32_t*, std::size_t, std::vector<std::byte>&);
extern template void pack(const std::uint64_t*, std::size_t, std::vector<std::byte>&);
extern template std::size_t unpack(const std::byte*, std::size_t, std::uint32_t*, std::size_t,
                                   const std::filesystem::path&);
extern template std::size_t unpack(const std::byte*, std::size_t, std::uint64_t*, std::size_t,
                                   const std::filesystem::path&);

}  // namespace pcm
