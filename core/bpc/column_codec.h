// Packs a sequence of integers: blocks of 128 values, each against its own base with its own bit width.
//
// A block is stored either as differences from its smallest value (frame of reference) or as zigzag differences from
// value to value; one choice for the whole sequence, whichever is smaller. Low bits that are zero in all differences of
// a block are not stored. A sequence of one repeated value takes 16 bytes. The layout is in FORMAT.md. Lossless.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

inline constexpr std::size_t codec_block = 128;

// Bytes that must be readable after the end of what unpack() is given.
inline constexpr std::size_t codec_slack = 16;

// Appends `count` values (count > 0) to `out`. Word is std::uint32_t or std::uint64_t.
template <class Word>
void pack(const Word* values, std::size_t count, std::vector<std::byte>& out);

// Reads `count` values from the `size` bytes at `data` and returns the bytes consumed. `data` must be followed by
// codec_slack readable bytes. Never reads or writes outside, whatever the bytes are; throws Error(corrupt) naming
// `path` for bytes that pack() cannot have written.
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
