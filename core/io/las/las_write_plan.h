// How a cloud becomes LAS records: its point format, the attributes in its fields and those in extra bytes.
#pragma once

#include "pcm/io/las/las_fields.h"
#include "pcm/io/las/las_target.h"
#include "pcm/io/reader.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm::las {

struct WriteColumn {
    std::size_t attribute = 0;  // in the cloud's schema
    Conversion conversion = Conversion::none;
    ScalarType type = ScalarType::u8;  // type of the field
    double factor = 1, addend = 0;     // rounded: the field holds raw * factor + addend
    Field field;
};

struct WritePlan {
    Target target;
    std::size_t record_length = 0;
    bool has_returns = false;  // otherwise every point is return 1 of 1
    std::vector<WriteColumn> columns;
    std::vector<std::byte> extra_bytes_vlr;  // payload, may be empty
    std::vector<std::string> notes;
};

// For choose_target(). An attribute that its field cannot hold goes to extra bytes of the name NAME_exact, and rounded
// to the field: intensities and colours scaled to the field's range, by options.survey where they have another than 0
// to 1. Throws Error(invalid_argument) for points of more than 65535 bytes.
WritePlan plan_writing(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options);

// Stores `count` values of `column`, starting with `first`, in the fields of records of zeros. Returns how many did not
// fit the bits of the field and were clamped to the largest that does. Rounded columns do not count: extra bytes hold
// their exact values.
std::uint64_t fill(const WriteColumn& column, const Column& values, std::size_t first, std::size_t count,
                   std::byte* records, std::size_t stride, std::vector<std::byte>& scratch);

}  // namespace pcm::las
