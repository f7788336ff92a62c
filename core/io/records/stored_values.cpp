#include "pcm/io/records/stored_values.h"

#include "pcm/cloud/with_type.h"
#include "pcm/io/records/scalars.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace pcm {
namespace {

bool is_float(ScalarType type) { return type == ScalarType::f32 || type == ScalarType::f64; }
bool has_64_bits(ScalarType type) { return type == ScalarType::i64 || type == ScalarType::u64; }
bool is_scaled(const Attribute& attribute) { return attribute.scale != 1 || attribute.offset != 0; }
bool is_colour(const Attribute& attribute)
{
    return attribute.name == attribute_name::rgb && attribute.components == 3;
}

double largest_raw(const Attribute& attribute, const ValueSurvey* known)
{
    if (known && known->any()) return std::max(std::fabs(known->least), std::fabs(known->most));
    return with_type(attribute.type, [](auto zero) {
        using Limits = std::numeric_limits<decltype(zero)>;
        return std::max(-static_cast<double>(Limits::lowest()), static_cast<double>(Limits::max()));
    });
}

}  // namespace

StoredAs stored_colours(const Attribute& attribute, const ValueSurvey* known, std::optional<unsigned> bits)
{
    StoredAs stored;
    stored.type = attribute.type;
    if (attribute.type == ScalarType::u8 || bits == 16u) return stored;
    stored.source = RecordField::Source::colour;
    stored.type = ScalarType::u8;
    stored.rounded = true;
    const double most = known && known->any() ? known->most : 0;
    if (attribute.type == ScalarType::u16) {
        stored.step = known ? known->colour_step : 0;
        stored.rounded = stored.step == 0;
        stored.factor = stored.step ? 1.0 / stored.step : 1.0 / 257;
    } else if (is_float(attribute.type) && most <= 1) {
        stored.factor = 255;
    } else {
        stored.factor = most <= 255 ? 1 : most <= 65535 ? 1.0 / 257 : 255 / most;
    }
    return stored;
}

StoredAs stored_values(const Attribute& attribute, const ValueSurvey* known)
{
    StoredAs stored;
    stored.type = attribute.type;
    if (!is_scaled(attribute) || !std::isfinite(attribute.scale) || !std::isfinite(attribute.offset)) return stored;
    stored.source = RecordField::Source::value;
    stored.type = ScalarType::f64;
    // Rounded by less than an eighth of a step, a value names its integer.
    const double step = std::fabs(attribute.scale);
    const double magnitude = largest_raw(attribute, known) * step + std::fabs(attribute.offset);
    const bool names_integers = magnitude * 0x1p-51 <= step / 8 && step > 0;
    stored.rounded = is_float(attribute.type) || !names_integers;
    if (!is_float(attribute.type) && names_integers && magnitude * 0x1p-23 <= step / 8) stored.type = ScalarType::f32;
    return stored;
}

RecordField field_of(const StoredAs& stored, std::size_t attribute, std::uint32_t components)
{
    RecordField field = RecordField::scalars(attribute, 0, stored.type, components);
    field.source = stored.source;
    field.factor = stored.factor;
    return field;
}

bool can_restore(const Attribute& attribute, ScalarType stored, unsigned step)
{
    if (step) return attribute.type == ScalarType::u16 && stored == ScalarType::u8 && step <= 257;
    return is_float(stored) && !is_float(attribute.type) && attribute.scale != 0;
}

std::uint64_t restore_values(const Attribute& attribute, ScalarType stored, unsigned step, bool swap,
                             const std::byte* from, std::size_t stride, std::size_t count, std::byte* to,
                             std::size_t to_stride)
{
    std::uint64_t wrong = 0;
    const auto restore = [&](auto field, auto raw) {
        using Field = decltype(field);
        using Raw = decltype(raw);
        const double low = static_cast<double>(std::numeric_limits<Raw>::lowest());
        const double beyond = std::ldexp(1.0, std::numeric_limits<Raw>::digits);
        for (std::size_t i = 0; i < count; ++i, from += stride, to += to_stride) {
            const Field value = swap ? load_scalar<Field, true>(from) : load_scalar<Field>(from);
            Raw number = 0;
            const double wanted =
                step ? static_cast<double>(value) * step
                     : std::nearbyint((static_cast<double>(value) - attribute.offset) / attribute.scale);
            const bool fits = wanted >= low && wanted < beyond;
            if (fits)
                number = static_cast<Raw>(wanted);
            else if (!std::isnan(wanted))
                number = wanted < low ? std::numeric_limits<Raw>::lowest() : std::numeric_limits<Raw>::max();
            wrong += !fits;
            std::memcpy(to, &number, sizeof number);
        }
    };
    with_type(attribute.type, [&](auto raw) {
        if constexpr (std::is_integral_v<decltype(raw)>) {
            if (stored == ScalarType::f64)
                restore(double{}, raw);
            else if (stored == ScalarType::f32)
                restore(float{}, raw);
            else
                restore(std::uint8_t{}, raw);
        }
    });
    return wrong;
}

void note_values_beyond(const Schema& schema, std::vector<std::uint64_t>& beyond, std::vector<std::string>& notes)
{
    for (std::size_t i = 0; i < beyond.size(); ++i) {
        if (beyond[i])
            notes.push_back(grouped(beyond[i]) + " values of '" + schema[i].name + "' do not fit its type, " +
                            std::string(name_of(schema[i].type)) +
                            ", which a comment of the file states; they are clamped");
        beyond[i] = 0;
    }
}

Question question_about(const Attribute& attribute, std::optional<unsigned> colour_bits, bool format_has_64_bits)
{
    if (is_colour(attribute)) {
        if (attribute.type == ScalarType::u8 || colour_bits == 16u) return Question::none;
        return attribute.type == ScalarType::u16 ? Question::colour_steps : Question::range;
    }
    if (!has_64_bits(attribute.type)) return Question::none;
    if (is_scaled(attribute)) return Question::range;
    return format_has_64_bits ? Question::none : Question::doubles;
}

}  // namespace pcm
