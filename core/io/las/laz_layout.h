// The payload of the laszip VLR (user id "laszip encoded", record id 22204), which describes how the records of a LAZ
// file are compressed. From LASzip's published format; a laszip item is a group of fields that is compressed together.
#pragma once

#include "pcm/io/las/las_layout.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm::laz {

enum class Compressor : std::uint16_t {
    none = 0,
    pointwise = 1,          // one chunk, without a chunk table
    pointwise_chunked = 2,  // chunks and a table of them
    layered_chunked = 3,    // the same, with each field in its own layer: point formats 6 to 10
};

enum ItemType : std::uint16_t {
    byte = 0,
    point10 = 6,
    gps_time = 7,
    rgb12 = 8,
    wave_packet13 = 9,
    point14 = 10,
    rgb14 = 11,
    rgb_nir14 = 12,
    wave_packet14 = 13,
    byte14 = 14,
};

struct Item {
    std::uint16_t type = 0, size = 0, version = 0;
    bool operator==(const Item& o) const { return type == o.type && size == o.size && version == o.version; }
};

inline constexpr std::uint32_t variable_chunks = 0xFFFFFFFF;
inline constexpr std::uint32_t default_chunk_points = 50000;

namespace vlr {
inline constexpr std::size_t compressor = 0;      // u16
inline constexpr std::size_t coder = 2;           // u16, 0: arithmetic
inline constexpr std::size_t version = 4;         // u8 major, u8 minor, u16 revision
inline constexpr std::size_t options = 8;         // u32
inline constexpr std::size_t chunk_points = 12;   // u32
inline constexpr std::size_t special_evlrs = 16;  // i64 count, i64 offset; -1: none
inline constexpr std::size_t item_count = 32;     // u16
inline constexpr std::size_t items = 34;          // each u16 type, u16 size, u16 version
inline constexpr std::size_t item_bytes = 6;
}  // namespace vlr

// The items of a point format in the versions that LASzip writes.
inline std::vector<Item> items_of(unsigned format, std::size_t extra_bytes)
{
    const auto extra = static_cast<std::uint16_t>(extra_bytes);
    std::vector<Item> items;
    if (las::is_extended(format)) {
        items.push_back({point14, 30, 3});
        if (las::has_nir(format))
            items.push_back({rgb_nir14, 8, 3});
        else if (las::has_rgb(format))
            items.push_back({rgb14, 6, 3});
        if (las::has_waves(format)) items.push_back({wave_packet14, 29, 3});
        if (extra) items.push_back({byte14, extra, 3});
        return items;
    }
    items.push_back({point10, 20, 2});
    if (las::has_gps_time(format)) items.push_back({gps_time, 8, 2});
    if (las::has_rgb(format)) items.push_back({rgb12, 6, 2});
    if (las::has_waves(format)) items.push_back({wave_packet13, 29, 1});  // its only version
    if (extra) items.push_back({byte, extra, 2});
    return items;
}

// Models of the arithmetic coder for extra bytes: one of 256 symbols per byte, four in layers.
inline std::size_t coder_bytes(unsigned format, std::size_t extra_bytes)
{
    constexpr std::size_t model = 2800, fields = std::size_t{4} << 20;
    return fields + extra_bytes * model * (las::is_extended(format) ? 4 : 1);
}
inline constexpr std::size_t most_coder_bytes = std::size_t{96} << 20;

}  // namespace pcm::laz
