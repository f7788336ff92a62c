// Information that a format has no field for, stored in comments of its header: scale and offset of attributes, their
// full names, opaque metadata. Used by PLY and PCD; other programs ignore comments.
//
//   pcm attribute <field> <type> <components> <scale> <offset> <name> <description>
//   pcm metadata <key> <bytes>
//   pcm data <base64>            as many lines as the metadata before them need
//
// Before them, for people: "crs: EPSG:32632 WGS 84 / UTM zone 32N", where the metadata state a coordinate system.
//
// An attribute line describes `components` consecutive fields, starting with <field>. Names, keys and descriptions are
// percent-encoded; an empty description is "-". Numbers are decimal, with enough digits to read back the same double.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/io/reader.h"

#include <string>
#include <string_view>
#include <vector>

namespace pcm {

struct CarriedAttribute {
    std::string field;    // of the file
    Attribute attribute;  // as the cloud has it
};

struct Carried {
    std::vector<CarriedAttribute> attributes;
    std::vector<Metadata> metadata;
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

// `name` as one word of a header: letters, digits, '_', '-', '.' and '+'; never empty.
std::string field_name(std::string_view name);

}  // namespace pcm
