// The header of a PCD file, the format of the Point Cloud Library: versions .5, .6 and .7.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/system/file.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

inline constexpr std::size_t longest_pcd_header = std::size_t{1} << 20;  // longer ones are refused
inline constexpr std::uint64_t most_pcd_record_bytes = std::uint64_t{16} << 20;

struct PcdField {
    std::string name;  // "_" for padding
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
    std::string viewpoint;              // as written in the file; empty when missing
    std::vector<std::string> comments;  // only those that begin with "pcm"
    std::vector<std::string> notes;
    std::uint64_t bytes = 0;  // offset of the data
    std::uint64_t lines = 0;  // number of lines of the header

    std::uint64_t record_bytes() const;  // size of a point, including padding; at most most_pcd_record_bytes
    std::uint64_t numbers() const;       // numbers of a point in ascii
};

// Throws Error(bad_format), naming the line, or Error(unsupported) for an unknown encoding and for larger records.
PcdHeader read_pcd_header(const File& file);

// The attribute's name for a field: this library's name for fields that PDAL and others spell differently ("GpsTime":
// gps_time), otherwise the field's own.
std::string pcd_attribute_name(std::string_view field);

}  // namespace pcm
