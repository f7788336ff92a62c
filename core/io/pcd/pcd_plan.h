// Where the fields of a PCD file go: coordinates, attributes, components of attributes.
#pragma once

#include "pcm/io/pcd/pcd_header.h"
#include "pcm/io/reader.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace pcm {

// The destination of a field.
struct PcdTarget {
    enum class Kind {
        none,           // padding, or it repeats an attribute that another field holds exactly
        axis,           // a coordinate
        scalars,        // an attribute, or a component, of the field's type
        restored,       // the same by restore_values()
        packed_colour,  // three colours of 8 bits, and alpha
    } kind = Kind::none;
    std::size_t index = 0;             // the axis or the attribute
    std::size_t byte = 0;              // first byte among the attribute's bytes of a point
    std::optional<std::size_t> alpha;  // packed_colour: this attribute's
    unsigned step = 0;                 // packed_colour: not 0: the attribute has 16 bits, steps of this
    ScalarType type = ScalarType::f32;
    std::size_t bytes = 0;   // size in a point
    std::size_t offset = 0;  // in a record
};

struct PcdPlan {
    std::vector<PcdTarget> targets;  // one per field
    std::size_t record_bytes = 0;
    // Positions are floats relative to this: coordinate_of_float() with the grid.
    std::optional<Vec3d> shift;
    std::optional<Grid> grid;
    bool viewpoint_is_shift = false;  // VIEWPOINT is the shift and no viewpoint
};

// Adds schema, position type, metadata and notes to `info`. Throws Error(bad_format | unsupported).
PcdPlan plan_pcd(const std::filesystem::path& path, const PcdHeader& header, FileInfo& info);

}  // namespace pcm
