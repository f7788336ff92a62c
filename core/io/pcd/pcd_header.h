// The header of a PCD file, the format of the Point Cloud Library: versions .5, .6 and .7.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/system/file.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

inline constexpr std::size_t longest_pcd_header = std::size_t{1} << 20;  // that is read
inline constexpr std::uint64_t most_pcd_record_bytes = std::uint64_t{16} << 20;

struct PcdField {
    std::string name;  // "_" for bytes that mean nothing
    ScalarType type = ScalarType::f32;
    std::uint32_t count = 1;

    bool is_padding() const { return name == "_"; }
    std::uint64_t bytes() const { return std::uint64_t{count} * size_of(type); }
};

struct PcdHeader {
    enum class Encoding { ascii, binary, compressed } encoding = Encoding::ascii;
    std::string version;
    std::vector<PcdField> fields;
    std::uint64_t width = 0, height = 1, points = 0;
    std::string viewpoint;              // as it stands there; empty when there is none
    std::vector<std::string> comments;  // those that begin with "pcm"
    std::vector<std::string> notes;
    std::uint64_t bytes = 0;  // the data begin here
    std::uint64_t lines = 0;  // of the header

    std::uint64_t record_bytes() const;  // of a point, padding included; at most most_pcd_record_bytes
    std::uint64_t numbers() const;       // of a point in ascii
};

// Throws Error(bad_format), naming the line, or Error(unsupported) for an unknown encoding and for larger records.
PcdHeader read_pcd_header(const File& file);

// What a field of this name is called as an attribute: the library's name for what PDAL and others spell in other ways
// ("GpsTime": gps_time), else its own.
std::string pcd_attribute_name(std::string_view field);

}  // namespace pcm
