// Byte layout of LAS files, shared by reader and writer. Offsets are bytes from the start of the structure; everything
// is little-endian. From the ASPRS LAS specifications 1.0 to 1.4 R15.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pcm::las {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "LAS scalars are copied as they are");

template <class T>
T load(const std::byte* from)
{
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

template <class T>
void store(std::byte* to, T value)
{
    std::memcpy(to, &value, sizeof(T));
}

namespace header {
inline constexpr std::size_t version_major = 24;
inline constexpr std::size_t version_minor = 25;
inline constexpr std::size_t system_identifier = 26;    // char[32]
inline constexpr std::size_t generating_software = 58;  // char[32]
inline constexpr std::size_t creation_day = 90;         // u16
inline constexpr std::size_t creation_year = 92;        // u16
inline constexpr std::size_t header_size = 94;          // u16
inline constexpr std::size_t point_offset = 96;         // u32
inline constexpr std::size_t vlr_count = 100;           // u32
inline constexpr std::size_t point_format = 104;        // u8, bits 6 and 7 set by LASzip
inline constexpr std::size_t record_length = 105;       // u16
inline constexpr std::size_t point_count_32 = 107;      // u32
inline constexpr std::size_t return_counts_32 = 111;    // u32[5]
inline constexpr std::size_t scale = 131;               // f64[3]
inline constexpr std::size_t offset = 155;              // f64[3]
inline constexpr std::size_t box = 179;                 // f64: max x, min x, max y, min y, max z, min z
inline constexpr std::size_t size_1_0 = 227;            // of 1.0, 1.1 and 1.2
inline constexpr std::size_t waveform_start = 227;      // u64, since 1.3
inline constexpr std::size_t size_1_3 = 235;
inline constexpr std::size_t evlr_start = 235;      // u64, since 1.4
inline constexpr std::size_t evlr_count = 243;      // u32
inline constexpr std::size_t point_count_64 = 247;  // u64
inline constexpr std::size_t size_1_4 = 375;
}  // namespace header

// Bytes of a record without extra bytes, by point format.
inline constexpr std::array<std::size_t, 11> record_bytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

}  // namespace pcm::las
