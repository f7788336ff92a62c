// Information that a format has no field for, stored in comments of its header: scale and offset of attributes, their
// full names, opaque metadata. Used by PLY and PCD; other programs ignore comments.
//
//   pcm attribute <field> <type> <components> <scale> <offset> <name> <description> [<step>]
//   pcm repeated <field> <count> <exact field>
//   pcm shift <x> <y> <z>
//   pcm metadata <key> <bytes>
//   pcm data <base64>            as many lines as the metadata before them need
//
// Before them, for people: "crs: EPSG:32632 WGS 84 / UTM zone 32N", where the metadata state a coordinate system.
//
// An attribute line describes `components` consecutive fields, starting with <field>. Fields of reals of an attribute
// of integers hold raw * scale + offset; with a <step>, a field is the raw number divided by it. Repeated fields are
// rounded copies, for other programs, of the attribute that starts with <exact field>. A shift was subtracted from the
// positions before they were rounded to floats. Names, keys and descriptions are percent-encoded; an empty description
// is "-". Numbers are decimal, with enough digits to read back the same double.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/io/reader.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

struct CarriedAttribute {
    std::string field;    // field of the file
    Attribute attribute;  // as the cloud has it
    unsigned step = 0;    // not 0: raw = field * step
};

struct RepeatedFields {
    std::string field;  // the first
    std::uint32_t count = 1;
    std::string exact;  // the first field of the attribute that they repeat
};

struct Carried {
    std::vector<CarriedAttribute> attributes;
    std::vector<Metadata> metadata;
    std::vector<RepeatedFields> repeated;
    std::optional<Vec3d> shift;
};

// Lines without line ends and comment marks, none longer than a few hundred bytes. Metadata beyond
// `carried_metadata_bytes` are left out and named in `notes`.
inline constexpr std::size_t carried_metadata_bytes = std::size_t{256} << 10;
std::vector<std::string> carried_comments(const Carried& carried, std::vector<std::string>& notes);

// Reads the lines above from all comments of a header; damaged ones are skipped and counted in `notes`.
Carried read_carried_comments(const std::vector<std::string>& comments, std::vector<std::string>& notes);

// Adds "pcm.grid", "sx sy sz ox oy oz": the scale and offset of a cloud on a grid, for formats that hold only
// coordinates. A hint: other programs may have moved points off the grid. Replaces an older one; does nothing for a
// cloud without a grid.
void add_grid(const FileInfo& cloud, std::vector<Metadata>& metadata);
// And back; nothing without it, or where it is damaged.
std::optional<Grid> carried_grid(const std::vector<Metadata>& metadata);

// `name` as one word of a header: letters, digits, '_', '-', '.' and '+'; never empty.
std::string field_name(std::string_view name);

}  // namespace pcm
