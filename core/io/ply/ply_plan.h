// Where the scalar properties of a PLY file's vertices go: coordinates, attributes, components of attributes.
#pragma once

#include "pcm/io/ply/ply_header.h"
#include "pcm/io/reader.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace pcm {

// The destination of a scalar property.
struct PlyTarget {
    enum class Kind {
        single,    // an attribute of its own, or a component, of the property's type
        axis,      // a coordinate
        restored,  // a component, by restore_values()
        skipped,   // repeats an attribute that other properties hold exactly
    };
    Kind kind = Kind::single;
    std::size_t index = 0;  // the axis, or the attribute
    std::size_t byte = 0;   // first byte among the attribute's bytes of a point
    unsigned step = 0;      // restored
    ScalarType type = ScalarType::f32;
    std::size_t offset = 0;  // in a record
};

struct PlyPlan {
    std::size_t vertex_element = 0;
    std::vector<PlyTarget> targets;  // targets of the scalar properties of a vertex, in file order
    std::size_t record_bytes = 0;    // size of all targets
};

// Adds schema, position type, number of points, metadata and notes to `info`. Throws Error(bad_format | unsupported).
PlyPlan plan_ply(const std::filesystem::path& path, const PlyHeader& header, FileInfo& info);

}  // namespace pcm
