// Where the attributes of a point lie in a LAS record: the fields of the point formats and the extra bytes behind them.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/io/las/las_header.h"

#include <cstddef>
#include <string>
#include <vector>

namespace pcm::las {

// Whole bytes of a record, or some bits of one byte.
struct Field {
    std::size_t offset = 0;
    std::size_t bytes = 0;  // of all components
    unsigned shift = 0;
    unsigned mask = 0;  // not 0: one byte, (byte >> shift) & mask
};

// One field for each attribute of the schema, in its order.
struct Fields {
    Schema schema;
    std::vector<Field> fields;
};

// Those of the specification, by its names in lower case: see las_reader.h.
Fields fields_of_format(unsigned format);
// With the extra bytes as their VLR describes them, which may lie about the record: then they are one attribute of
// plain bytes, and a note says why.
Fields fields_of_file(const Header& header, const std::vector<Vlr>& vlrs, std::vector<std::string>& notes);

// An attribute of more than three components has a descriptor for each, "name[0]", "name[1]", ...: no data type has so
// many.
std::string component_name(const std::string& name, std::size_t component);
// The description of extra bytes that hold what the field of the same name in the point format cannot: they are read in
// its place.
inline constexpr const char* exact_description = "exact; the field has it rounded";

// Values of `count` records that lie `stride` bytes apart: out of their field, one after the other, ...
void gather(const Field& field, const std::byte* records, std::size_t stride, std::size_t count, std::byte* to);
// ... and into it. Bits that were set before stay set: records begin as zeros.
void scatter(const Field& field, const std::byte* values, std::size_t count, std::byte* records, std::size_t stride);

}  // namespace pcm::las
