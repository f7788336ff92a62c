// Attributes whose raw numbers other programs would take for something else, in fields that these read rightly: scaled
// integers as their values, colours with 8 bits. Where that is not exact, the attribute gets fields of its own too.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/io/records/record_encoder.h"
#include "pcm/io/survey.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct StoredAs {
    RecordField::Source source = RecordField::Source::attribute;
    ScalarType type = ScalarType::u8;  // type of the field
    double factor = 1;                 // colours: RecordField::factor
    unsigned step = 0;                 // colours: raw = field * step; 0: the field has the raw numbers, or values
    bool rounded = false;              // the raw numbers cannot be restored from the field

    bool raw() const { return source == RecordField::Source::attribute; }
};

// For "rgb" of three components. `known` may be null: then nothing is known of the colours. With `bits` 16 they stay.
StoredAs stored_colours(const Attribute& attribute, const ValueSurvey* known, std::optional<unsigned> bits);

// For all others: as they are unless they have a scale or an offset.
StoredAs stored_values(const Attribute& attribute, const ValueSurvey* known);

// The field of a whole attribute stored so.
RecordField field_of(const StoredAs& stored, std::size_t attribute, std::uint32_t components);

// Whether restore_values() gives the raw numbers of `attribute` from fields of this type.
bool can_restore(const Attribute& attribute, ScalarType stored, unsigned step);

// One component: `count` fields of type `stored`, `stride` bytes apart, back to raw numbers of the attribute's type,
// `to_stride` bytes apart. `swap`: fields are in big endian. Returns how many fields have no such number (another
// program has changed them): they are clamped, NaN to 0.
std::uint64_t restore_values(const Attribute& attribute, ScalarType stored, unsigned step, bool swap,
                             const std::byte* from, std::size_t stride, std::size_t count, std::byte* to,
                             std::size_t to_stride);

// Adds a note for each attribute of which restore_values() returned more than 0 altogether, and sets the number to 0.
void note_values_beyond(const Schema& schema, std::vector<std::uint64_t>& beyond, std::vector<std::string>& notes);

// What to ask of a cloud's values before its file is created.
Question question_about(const Attribute& attribute, std::optional<unsigned> colour_bits, bool has_64_bits);

}  // namespace pcm
