// Byte layout of LAS files, shared by reader and writer. Offsets are bytes from the start of the structure; everything
// is little-endian. From the ASPRS LAS specifications 1.0 to 1.4 R15 and 1.5 R00.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace pcm::las {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "LAS scalars are copied without byte swapping");

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
inline constexpr std::size_t file_source_id = 4;   // u16, since 1.1
inline constexpr std::size_t global_encoding = 6;  // u16, since 1.2
inline constexpr std::size_t guid = 8;             // 16 bytes
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
inline constexpr std::size_t size_1_0 = 227;            // versions 1.0, 1.1 and 1.2
inline constexpr std::size_t waveform_start = 227;      // u64, since 1.3
inline constexpr std::size_t size_1_3 = 235;
inline constexpr std::size_t evlr_start = 235;        // u64, since 1.4
inline constexpr std::size_t evlr_count = 243;        // u32
inline constexpr std::size_t point_count_64 = 247;    // u64
inline constexpr std::size_t return_counts_64 = 255;  // u64[15]
inline constexpr std::size_t size_1_4 = 375;
inline constexpr std::size_t gps_time_max = 375;  // f64, since 1.5
inline constexpr std::size_t gps_time_min = 383;  // f64
inline constexpr std::size_t time_offset = 391;   // u16, millions of seconds
inline constexpr std::size_t size_1_5 = 393;

constexpr std::size_t size_of_version(unsigned minor)
{
    return minor >= 4 ? size_1_4 : minor == 3 ? size_1_3 : size_1_0;
}
}  // namespace header

// Bits of global_encoding.
namespace encoding {
inline constexpr unsigned gps_standard_time = 1;
inline constexpr unsigned waveforms_inside = 2, waveforms_beside = 4;
inline constexpr unsigned wkt = 16;
inline constexpr unsigned time_offset = 64;  // since 1.5, with gps_standard_time: the header states the offset
constexpr unsigned bits_of_version(unsigned minor) { return minor >= 4 ? 31 : minor == 3 ? 15 : minor == 2 ? 1 : 0; }
}  // namespace encoding

// Variable length records: reserved u16, user id char[16], record id u16, length (u16, extended: u64), description
// char[32].
inline constexpr std::size_t vlr_header_bytes = 54;
inline constexpr std::size_t evlr_header_bytes = 60;
inline constexpr std::string_view spec_user_id = "LASF_Spec";
inline constexpr std::uint16_t extra_bytes_record_id = 4;
inline constexpr std::uint16_t waveforms_record_id = 65535;  // user id LASF_Spec: the waveforms themselves
inline constexpr std::string_view projection_user_id = "LASF_Projection";
inline constexpr std::uint16_t wkt_record_id = 2112;  // coordinate system
inline constexpr std::string_view laszip_user_id = "laszip encoded";
inline constexpr std::uint16_t laszip_record_id = 22204;

// Entries of the Extra Bytes VLR.
namespace extra {
inline constexpr std::size_t descriptor_bytes = 192;
inline constexpr std::size_t data_type = 2;      // u8
inline constexpr std::size_t options = 3;        // u8
inline constexpr std::size_t name = 4;           // char[32]
inline constexpr std::size_t scale = 112;        // f64[3]
inline constexpr std::size_t offset = 136;       // f64[3]
inline constexpr std::size_t description = 160;  // char[32]
inline constexpr unsigned has_scale = 0x08, has_offset = 0x10;
}  // namespace extra

// Bytes of a record without extra bytes, for each point format.
inline constexpr std::array<std::size_t, 11> record_bytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
inline constexpr unsigned format_count = 11;

// Properties of the point formats.
constexpr bool is_extended(unsigned format) { return format >= 6; }  // 4-bit returns, 8-bit classes, LAS 1.4
constexpr unsigned first_minor(unsigned format)                      // the first version that has it
{
    return format >= 6 ? 4 : format >= 4 ? 3 : format >= 2 ? 2 : 0;
}
constexpr bool has_gps_time(unsigned format) { return format != 0 && format != 2; }
constexpr bool has_rgb(unsigned format)
{
    return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}
constexpr bool has_nir(unsigned format) { return format == 8 || format == 10; }
constexpr bool has_waves(unsigned format) { return format == 4 || format == 5 || format == 9 || format == 10; }

}  // namespace pcm::las
