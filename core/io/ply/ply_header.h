// The header of a PLY file, which describes the data after it.
//
// From Greg Turk, The PLY Polygon File Format (1994), with the sized type names (int8, float32, ...) that came later.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/system/file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

inline constexpr std::size_t longest_ply_header = std::size_t{1} << 20;  // longer ones are refused

struct PlyProperty {
    std::string name;
    ScalarType type = ScalarType::f32;  // for a list, of its items
    bool is_list = false;
    ScalarType count_type = ScalarType::u8;  // type of a list's length; an integer
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    bool has_lists() const;
    // Bytes of one instance in a binary file, with empty lists.
    std::uint64_t least_bytes() const;
};

struct PlyHeader {
    enum class Encoding { ascii, little_endian, big_endian } encoding = Encoding::ascii;
    std::vector<PlyElement> elements;
    std::vector<std::string> comments;  // only those that begin with "pcm"
    std::uint64_t bytes = 0;            // offset of the data
    std::uint64_t lines = 0;            // number of lines of the header
    bool ends_lines_with_cr = false;    // CR alone, as in old Macintosh files
};

// Throws Error(bad_format), naming the line, or Error(unsupported) for another version of the format.
PlyHeader read_ply_header(const File& file);

}  // namespace pcm
