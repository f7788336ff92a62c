// Where the attributes of a point are in a LAS record: the fields of the point formats and the extra bytes after them.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/io/las/las_header.h"
#include "pcm/io/record_batch.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace pcm::las {

using Field = FieldPlace;

// One field per attribute of the schema, in its order.
struct Fields {
    Schema schema;
    std::vector<Field> fields;
};

// The fields of the specification, with its names in lower case: see las_reader.h.
Fields fields_of_format(unsigned format);
// The same, with the extra bytes as their VLR describes them; several VLRs describe them one after the other, which is
// noted. Where the VLR contradicts the record, they are one
// attribute of plain bytes, and a note says why.
Fields fields_of_file(const Header& header, const std::vector<Vlr>& vlrs, std::vector<std::string>& notes);

// The extra bytes in which programs for LAS keep normals, which are one attribute "normal" here.
inline constexpr std::array<const char*, 3> normal_names{"NormalX", "NormalY", "NormalZ"};
bool is_normal_name(const std::string& name, std::size_t component);  // in any case

// An attribute of more than three components has one descriptor per component, "name[0]", "name[1]", ...: no data type
// has that many.
std::string component_name(const std::string& name, std::size_t component);
// Extra bytes with the values of an attribute that the field of its name cannot hold have this description and this
// name, NAME_exact; they are read instead of the field. Extra bytes with the name of a field itself, which other
// software refuses, are read so too. Written to files: do not change.
inline constexpr const char* exact_description = "exact; the field has it rounded";
std::string exact_name(const std::string& field);

// Whether a point format has a field of this name, as laspy spells it too: other software refuses extra bytes so named.
bool is_name_of_a_field(unsigned format, const std::string& name);

// Copies values of `count` records, `stride` bytes apart, from their field to consecutive values, ...
void gather(const Field& field, const std::byte* records, std::size_t stride, std::size_t count, std::byte* to);
// ... and back. Bits are only set, never cleared: records must be zeros before.
void scatter(const Field& field, const std::byte* values, std::size_t count, std::byte* records, std::size_t stride);

}  // namespace pcm::las
