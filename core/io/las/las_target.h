// Which version and point format of LAS a cloud is written as.
#pragma once

#include "pcm/io/las/las_fields.h"
#include "pcm/io/survey.h"
#include "pcm/io/writer.h"

#include <cstdint>
#include <optional>

namespace pcm::las {

// How values of an attribute are converted for a field.
enum class Conversion : std::uint8_t {
    none,     // the same bytes
    widened,  // the same numbers in a larger type
    colours,  // 8 bits to 16: times 257, so that 255 becomes 65535
    rounded,  // rounded and clamped to the field's range; extra bytes hold the exact values
};

// How an attribute is stored exactly in the field of its name; nothing when the field cannot hold it. Values for a
// field of a few bits (`mask`) are taken to fit unless `known` says otherwise.
std::optional<Conversion> exact_conversion(const Attribute& attribute, const Attribute& field, unsigned mask,
                                           const ValueSurvey* known);

// The header of the LAS file that the cloud came from, its bytes; null without one.
const std::vector<std::byte>* source_header(const FileInfo& cloud);

inline bool is_float(ScalarType type) { return type == ScalarType::f32 || type == ScalarType::f64; }

struct Target {
    unsigned format = 0;
    unsigned minor = 2;  // minor version number
    bool minor_is_asked = false;
};

// The format and version of the source, if the cloud still has all fields of that format, its values fit them, and
// options.las_version allows it. Otherwise, of the allowed formats, the one that stores the maximum number of
// attributes exactly in its fields; among those the one whose field names match the maximum number of others; among
// those the smallest; and the version asked for, or the lowest that has this format: at least the source's, or 1.2.
// Throws Error(invalid_argument) for a version beyond 1.4.
Target choose_target(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options);

// What choose_target() and plan_writing() want to know: see Format::questions.
SurveyQuestions questions_about(const FileInfo& cloud, const WriteOptions& options);

}  // namespace pcm::las
