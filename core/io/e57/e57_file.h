// The description of an E57 file: its scans, and the fields of their points. ASTM E2807-11.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/io/e57/e57_pages.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// One number of a point: a float, a double, or raw * scale + offset of an integer.
struct E57Field {
    enum class Kind { f32, f64, integer };

    std::string space;  // prefix of an extension's namespace; empty for the standard's own fields
    std::string name;   // "cartesianX", "pointSourceId"
    Kind kind = Kind::f64;
    std::int64_t min = 0, max = 0;  // integers: the declared range, min <= max
    double scale = 1, offset = 0;   // integers

    bool scaled() const { return scale != 1 || offset != 0; }
    // Bits of a value in its byte stream; 0 when the field has a single possible value.
    unsigned bits() const;
};

struct E57Scan {
    std::string name, guid;
    std::uint64_t file_offset = 0;  // physical offset of the section with the points
    std::uint64_t records = 0;
    std::vector<E57Field> fields;
    bool has_pose = false;
    std::array<double, 4> rotation{1, 0, 0, 0};  // w x y z, as stored in the file
    Vec3d translation{0, 0, 0};
    std::optional<Box3d> box;            // before the pose
    std::optional<double> colour_limit;  // the highest maximum of the colours

    // The index of a field of the standard.
    std::optional<std::size_t> find(std::string_view field) const;
    std::string called(std::size_t index) const;  // "scan 3 ('east')" for messages, counted from 1
};

struct E57Description {
    std::string xml;
    std::string coordinate_metadata;
    std::size_t images = 0;
    std::vector<E57Scan> scans;
};

// Reads the header and the XML section. Memory is bounded whatever they contain. Throws Error(truncated | corrupt |
// bad_format) naming the byte, and Error(unsupported) for an XML section that is too large and in a build without the
// decoders.
E57Description describe_e57(E57Pages& pages);

}  // namespace pcm
