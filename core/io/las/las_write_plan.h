// How a cloud becomes LAS records: its point format, the attributes in its fields and those in extra bytes.
#pragma once

#include "pcm/io/las/las_fields.h"
#include "pcm/io/reader.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm::las {

// How values of an attribute are converted for a field.
enum class Conversion : std::uint8_t {
    none,     // the same bytes
    widened,  // the same numbers in a larger type
    colours,  // 8 bits to 16: times 257, so that 255 becomes 65535
    rounded,  // rounded and clamped to the field's range; extra bytes hold the exact values
};

struct WriteColumn {
    std::size_t attribute = 0;  // in the cloud's schema
    Conversion conversion = Conversion::none;
    ScalarType type = ScalarType::u8;  // of the field
    double scale = 1, offset = 0;      // of the field: it holds (value - offset) / scale, rounded
    Field field;
};

struct WritePlan {
    unsigned format = 0;
    std::size_t record_length = 0;
    bool has_returns = false;  // otherwise every point is return 1 of 1
    std::vector<WriteColumn> columns;
    std::vector<std::byte> extra_bytes_vlr;  // payload, may be empty
    std::vector<std::string> notes;
};

// The point format is that of the cloud's own LAS header if the cloud still has all of its fields. Otherwise it is the
// one that stores the most attributes exactly in its fields; among those the one with fields of the same names for the
// most other attributes; among those the smallest. Throws Error(invalid_argument) for points of more than 65535 bytes.
WritePlan plan_writing(const std::filesystem::path& path, const FileInfo& cloud);

// Stores `count` values of `column`, starting with `first`, in the fields of records of zeros. Returns how many did not
// fit the bits of the field and were clamped to the largest that does. Rounded columns do not count: extra bytes hold
// their exact values.
std::uint64_t fill(const WriteColumn& column, const Column& values, std::size_t first, std::size_t count,
                   std::byte* records, std::size_t stride, std::vector<std::byte>& scratch);

}  // namespace pcm::las
