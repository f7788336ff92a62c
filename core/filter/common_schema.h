// One type for the attributes of several clouds that have the same name and different types.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/point_batch.h"

#include <string>
#include <vector>

namespace pcm {

struct CommonSchemas {
    std::vector<Schema> schemas;     // schema of each cloud, as it is to be read
    std::vector<std::string> notes;  // a line for each attribute that is converted
};

// Attributes of one name and one number of components get one type, which holds the values of all exactly: the smallest
// integer type that has the ranges of theirs; f32 for f32 and integers of up to 16 bits; else f64, also where scales or
// offsets differ, whose values are then those of the attributes' own units (a 64-bit integer beyond 2^53 is rounded).
// Colours become 16 bits: 8 bits times 257, floats (0 to 1) times 65535, rounded. Other attributes stay; MergedReader
// keeps those apart that differ in their number of components.
CommonSchemas common_schemas(const std::vector<Schema>& schemas);

// Converts a column, of attribute `from`, to `to`.
void convert_column(const Attribute& from, const Column& column, const Attribute& to, Column& converted);

}  // namespace pcm
