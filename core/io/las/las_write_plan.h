// How a cloud becomes LAS records: which point format, which attributes in its fields, which as extra bytes.
#pragma once

#include "pcm/io/las/las_fields.h"
#include "pcm/io/reader.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm::las {

// What happens to the values of an attribute on their way into a field.
enum class Conversion : std::uint8_t {
    none,     // the same bytes
    widened,  // the same numbers in a larger type
    colours,  // 8 bits to 16: times 257, so that 255 becomes 65535
    rounded,  // numbers beside which the exact ones stand as extra bytes: rounded and cut to the field's range
};

struct WriteColumn {
    std::size_t attribute = 0;  // in the cloud's schema
    Conversion conversion = Conversion::none;
    ScalarType type = ScalarType::u8;  // of the field
    double scale = 1, offset = 0;      // of the field: rounded numbers are (value - offset) / scale
    Field field;
};

struct WritePlan {
    unsigned format = 0;
    std::size_t record_length = 0;
    bool has_returns = false;  // else every point is return 1 of 1
    std::vector<WriteColumn> columns;
    std::vector<std::byte> extra_bytes_vlr;  // payload, may be empty
    std::vector<std::string> notes;
};

// The format of the cloud's own LAS header where the cloud still has all of its fields; else the one that carries the
// most attributes in its fields exactly, of those the one with fields of the same names for the most others, of those
// the smallest. Throws Error(invalid_argument) for points of more than 65535 bytes.
WritePlan plan_writing(const std::filesystem::path& path, const FileInfo& cloud);

// `count` values of `column`, starting with the `first`, into the fields of records of zeros. Returns how many did not
// fit the bits of the field and were cut to the largest that does; never those of rounded columns, whose exact values
// are beside them.
std::uint64_t fill(const WriteColumn& column, const Column& values, std::size_t first, std::size_t count,
                   std::byte* records, std::size_t stride, std::vector<std::byte>& scratch);

}  // namespace pcm::las
