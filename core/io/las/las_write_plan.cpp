#include "pcm/io/las/las_write_plan.h"

#include "pcm/cloud/with_type.h"
#include "pcm/io/las/las_layout.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace pcm::las {
namespace {

constexpr std::size_t most_name_bytes = 32;
constexpr std::size_t most_record_bytes = 65535;

bool is_float(ScalarType type) { return type == ScalarType::f32 || type == ScalarType::f64; }
bool is_signed(ScalarType type)
{
    return type == ScalarType::i8 || type == ScalarType::i16 || type == ScalarType::i32 || type == ScalarType::i64;
}

// Whether type `to` can represent every value of type `from`.
bool widens(ScalarType from, ScalarType to)
{
    if (from == to) return true;
    if (is_float(to)) {
        if (is_float(from)) return size_of(from) <= size_of(to);
        return size_of(from) < size_of(to);
    }
    if (is_float(from)) return false;
    if (is_signed(from) && !is_signed(to)) return false;
    return size_of(from) < size_of(to);
}

// How an attribute is stored exactly in the field of its name; null when the field cannot hold it.
std::optional<Conversion> exact_conversion(const Attribute& attribute, const Attribute& field, unsigned mask)
{
    if (attribute.components != field.components) return std::nullopt;
    if (attribute.name == attribute_name::rgb && attribute.type == ScalarType::u8 && attribute.scale == 1 &&
        attribute.offset == 0)
        return Conversion::colours;
    if (attribute.scale != field.scale || attribute.offset != field.offset) return std::nullopt;
    if (attribute.type == field.type) return Conversion::none;
    if (!mask && widens(attribute.type, field.type)) return Conversion::widened;
    return std::nullopt;
}

bool names_all_of(const Schema& cloud, const Schema& fields)
{
    return std::all_of(fields.begin(), fields.end(),
                       [&](const Attribute& f) { return cloud.find(f.name).has_value(); });
}

bool has_all_of(const Schema& cloud, const Schema& fields)
{
    return std::all_of(fields.begin(), fields.end(), [&](const Attribute& f) {
        const auto i = cloud.find(f.name);
        return i && cloud[*i].type == f.type && cloud[*i].components == f.components && cloud[*i].scale == f.scale;
    });
}

unsigned choose_format(const FileInfo& cloud)
{
    for (const Metadata& block : cloud.metadata) {
        if (block.key != header_key || block.value.size() <= header::point_format) continue;
        const unsigned format = load<std::uint8_t>(&block.value[header::point_format]) & 0x3Fu;
        if (format < format_count && names_all_of(cloud.schema, fields_of_format(format).schema)) return format;
        break;
    }
    unsigned best = 0;
    std::size_t most = 0, most_named = 0;
    bool best_is_whole = false;
    for (unsigned format = 0; format < format_count; ++format) {
        const Fields native = fields_of_format(format);
        // A cloud from LAS has all fields of its format, and they can hold its values.
        const bool whole = has_all_of(cloud.schema, native.schema);
        std::size_t carried = 0, named = 0;
        for (const Attribute& attribute : cloud.schema) {
            const auto i = native.schema.find(attribute.name);
            named += i.has_value();
            if (!i || !exact_conversion(attribute, native.schema[*i], native.fields[*i].mask)) continue;
            // 8-bit classes are common; the old formats have 5 bits.
            if (attribute.name == attribute_name::classification && native.fields[*i].mask && !whole) continue;
            ++carried;
        }
        const bool better = whole != best_is_whole ? whole
                            : carried != most      ? carried > most
                            : named != most_named  ? named > most_named
                                                   : record_bytes[format] < record_bytes[best];
        if (format == 0 || better) {
            best = format;
            most = carried;
            most_named = named;
            best_is_whole = whole;
        }
    }
    return best;
}

// The first `most` bytes, without an incomplete UTF-8 character at the end.
std::string cut_text(const std::string& text, std::size_t most)
{
    if (text.size() <= most) return text;
    std::size_t end = most;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
    return text.substr(0, end);
}

class Planner {
public:
    Planner(const std::filesystem::path& path, const FileInfo& cloud) : path_(path), cloud_(cloud)
    {
        plan_.format = choose_format(cloud);
        plan_.record_length = record_bytes[plan_.format];
        native_ = fields_of_format(plan_.format);
        for (const Attribute& field : native_.schema) taken_.insert(field.name);
        for (const Metadata& block : cloud.metadata)
            if (const auto vlr = from_metadata(block))
                if (vlr->user_id == spec_user_id && vlr->id == extra_bytes_record_id &&
                    vlr->value.size() % extra::descriptor_bytes == 0)
                    source_descriptors_.insert(source_descriptors_.end(), vlr->value.begin(), vlr->value.end());
    }

    WritePlan plan()
    {
        // Undescribed bytes come last, where the reader expects them.
        std::optional<std::size_t> undescribed;
        for (std::size_t i = 0; i < cloud_.schema.size(); ++i) {
            const Attribute& attribute = cloud_.schema[i];
            const auto place = native_.schema.find(attribute.name);
            if (place) {
                into_field(i, *place);
            } else if (is_undescribed(attribute) && i + 1 == cloud_.schema.size()) {
                undescribed = i;
            } else {
                into_extra_bytes(i, attribute.name, attribute.description);
            }
        }
        if (undescribed) add_field(*undescribed, cloud_.schema[*undescribed].bytes());
        plan_.has_returns = cloud_.schema.find("return_number") || cloud_.schema.find("number_of_returns");
        if (plan_.record_length > most_record_bytes)
            throw Error(ErrorCode::invalid_argument, path_,
                        "a point would take " + std::to_string(plan_.record_length) + " bytes; LAS allows 65535",
                        "write fewer attributes");
        return std::move(plan_);
    }

private:
    static bool is_plain_bytes(const Attribute& a) { return a.type == ScalarType::u8 && a.scale == 1 && a.offset == 0; }
    bool is_undescribed(const Attribute& a) const
    {
        return a.name == "extra_bytes" && is_plain_bytes(a) && a.description.empty();
    }

    void add_field(std::size_t attribute, std::size_t bytes)
    {
        WriteColumn column;
        column.attribute = attribute;
        column.type = cloud_.schema[attribute].type;
        column.field = {plan_.record_length, bytes, 0, 0};
        plan_.columns.push_back(column);
        plan_.record_length += bytes;
    }

    void into_field(std::size_t i, std::size_t place)
    {
        const Attribute& attribute = cloud_.schema[i];
        const Attribute& field = native_.schema[place];
        WriteColumn column;
        column.attribute = i;
        column.type = field.type;
        column.scale = field.scale;
        column.offset = field.offset;
        column.field = native_.fields[place];
        if (const auto exact = exact_conversion(attribute, field, column.field.mask)) {
            column.conversion = *exact;
            plan_.columns.push_back(column);
            if (*exact == Conversion::colours)
                plan_.notes.push_back("colours of 8 bits are written with 16, times 257: 255 is 65535");
            return;
        }
        // Other software reads the field; our reader takes the exact values.
        const std::string what = "'" + attribute.name + "' is " + std::string(name_of(attribute.type)) +
                                 (attribute.components > 1 ? " x " + std::to_string(attribute.components) : "");
        if (attribute.components == field.components) {
            column.conversion = Conversion::rounded;
            plan_.columns.push_back(column);
            plan_.notes.push_back(
                what + ", for which point format " + std::to_string(plan_.format) +
                " has no field: it is kept exactly as extra bytes, and rounded in the field of that name");
        } else {
            plan_.notes.push_back(what + ", for which point format " + std::to_string(plan_.format) +
                                  " has no field: it is kept exactly as extra bytes");
        }
        if (!attribute.description.empty() && attribute.description != exact_description)
            plan_.notes.push_back("the description of '" + attribute.name + "' is not kept");
        into_extra_bytes(i, attribute.name, exact_description);
    }

    void into_extra_bytes(std::size_t i, const std::string& name, const std::string& description)
    {
        const Attribute& attribute = cloud_.schema[i];
        const std::string text = cut_text(description, most_name_bytes);
        if (text != description) plan_.notes.push_back("the description of '" + name + "' is cut to 32 bytes");
        const bool plain = is_plain_bytes(attribute) && attribute.components > 3 && attribute.components <= 255;
        const bool one_descriptor = attribute.components <= 3 || plain;
        const bool exact = description == exact_description;
        // With room for the longest suffix of a component.
        const std::size_t suffix = one_descriptor ? 0 : component_name("", attribute.components - 1).size();
        const std::string short_name = exact ? name : free_name(name, most_name_bytes - suffix);
        if (short_name != name)
            plan_.notes.push_back("'" + name + "' is written as '" + short_name +
                                  "': names have at most 32 bytes and must be unique");
        for (std::uint32_t c = 0; c < (one_descriptor ? 1u : attribute.components); ++c)
            add_descriptor(attribute, one_descriptor ? short_name : component_name(short_name, c), text,
                           one_descriptor ? attribute.components : 1, plain);
        add_field(i, attribute.bytes());
    }

    std::string free_name(const std::string& name, std::size_t most)
    {
        std::string candidate = cut_text(name, most);
        for (int number = 2; taken_.count(candidate); ++number) {
            const std::string ending = "_" + std::to_string(number);
            candidate = cut_text(name, most - ending.size()) + ending;
        }
        taken_.insert(candidate);
        return candidate;
    }

    void add_descriptor(const Attribute& attribute, const std::string& name, const std::string& description,
                        std::uint32_t components, bool plain)
    {
        std::byte d[extra::descriptor_bytes]{};
        // In the order of the specification: u8 1, i8 2, u16 3, ... f32 9, f64 10; pairs from 11, triples from 21.
        static constexpr std::uint8_t types[] = {2, 1, 4, 3, 6, 5, 8, 7, 9, 10};
        const auto type =
            static_cast<std::uint8_t>(types[static_cast<std::size_t>(attribute.type) - 1] + 10 * (components - 1));
        unsigned options = attribute.scale != 1 ? extra::has_scale : 0;
        if (attribute.offset != 0) options |= extra::has_offset;
        if (plain) options = components;
        store(d + extra::data_type, plain ? std::uint8_t{0} : type);
        store(d + extra::options, static_cast<std::uint8_t>(options));
        std::memcpy(d + extra::name, name.data(), name.size());
        std::memcpy(d + extra::description, description.data(), description.size());
        for (std::uint32_t c = 0; !plain && c < components; ++c) {
            if (options & extra::has_scale) store(d + extra::scale + 8 * c, attribute.scale);
            if (options & extra::has_offset) store(d + extra::offset + 8 * c, attribute.offset);
        }
        const std::byte* same = source_descriptor(d, attribute);
        const std::byte* from = same ? same : d;
        plan_.extra_bytes_vlr.insert(plan_.extra_bytes_vlr.end(), from, from + extra::descriptor_bytes);
    }

    // The source file's descriptor if it describes the same: it may also hold the "no data" value and the range.
    const std::byte* source_descriptor(const std::byte* d, const Attribute& attribute) const
    {
        constexpr unsigned about_the_type = extra::has_scale | extra::has_offset;
        const auto type = load<std::uint8_t>(d + extra::data_type);
        const unsigned options = load<std::uint8_t>(d + extra::options) & about_the_type;
        const auto same = [&](const std::byte* source, std::size_t at, std::size_t bytes) {
            return std::memcmp(source + at, d + at, bytes) == 0;
        };
        for (std::size_t i = 0; i + extra::descriptor_bytes <= source_descriptors_.size();
             i += extra::descriptor_bytes) {
            const std::byte* source = &source_descriptors_[i];
            if (!same(source, extra::name, 32) || !same(source, extra::description, 32)) continue;
            const auto source_type = load<std::uint8_t>(source + extra::data_type);
            const auto source_options = load<std::uint8_t>(source + extra::options);
            if (source_type == 0) {
                if (is_plain_bytes(attribute) && source_options == attribute.components) return source;
            } else if (source_type == type && (source_options & about_the_type) == options &&
                       (!(options & extra::has_scale) || same(source, extra::scale, 24)) &&
                       (!(options & extra::has_offset) || same(source, extra::offset, 24))) {
                return source;
            }
        }
        return nullptr;
    }

    const std::filesystem::path& path_;
    const FileInfo& cloud_;
    WritePlan plan_;
    Fields native_;
    std::set<std::string> taken_;
    std::vector<std::byte> source_descriptors_;
};

template <class To>
void put_rounded(const WriteColumn& column, const Column& values, std::size_t first, std::size_t count, bool colours,
                 std::byte* scratch)
{
    const std::uint32_t components = values.components();
    // Float colours are 0 to 1.
    const double factor = colours ? 65535.0 : 1.0 / column.scale;
    const double low = static_cast<double>(std::numeric_limits<To>::lowest());
    const double high = column.field.mask ? column.field.mask : static_cast<double>(std::numeric_limits<To>::max());
    for (std::size_t i = 0; i < count * components; ++i) {
        const double value = values.value(first + i / components, static_cast<std::uint32_t>(i % components));
        double rounded = (value - column.offset) * factor;
        if (std::numeric_limits<To>::is_integer) rounded = std::nearbyint(rounded);
        To number = 0;
        if (rounded >= high)
            number = std::numeric_limits<To>::is_integer && !column.field.mask ? std::numeric_limits<To>::max()
                                                                               : static_cast<To>(high);
        else if (rounded > low)
            number = static_cast<To>(rounded);
        else if (rounded <= low)
            number = std::numeric_limits<To>::lowest();
        std::memcpy(scratch + i * sizeof(To), &number, sizeof(To));
    }
}

template <class To, class From>
void widen(const std::byte* from, std::size_t count, std::byte* to)
{
    for (std::size_t i = 0; i < count; ++i) {
        const To number = static_cast<To>(load<From>(from + i * sizeof(From)));
        store(to + i * sizeof(To), number);
    }
}

std::uint64_t cut_to_bits(const Field& field, const std::byte* values, std::size_t count, std::byte* to)
{
    const auto most = static_cast<std::byte>(field.mask);
    std::uint64_t cut = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const bool fits = values[i] <= most;
        to[i] = fits ? values[i] : most;
        cut += !fits;
    }
    return cut;
}

}  // namespace

WritePlan plan_writing(const std::filesystem::path& path, const FileInfo& cloud) { return Planner(path, cloud).plan(); }

std::uint64_t fill(const WriteColumn& column, const Column& values, std::size_t first, std::size_t count,
                   std::byte* records, std::size_t stride, std::vector<std::byte>& scratch)
{
    const std::byte* from = values.data() + first * values.point_bytes();
    const std::size_t numbers = count * values.components();
    if (column.conversion == Conversion::none && !column.field.mask) {
        scatter(column.field, from, count, records, stride);
        return 0;
    }
    scratch.resize(numbers * size_of(column.type));
    std::uint64_t cut = 0;
    switch (column.conversion) {
        case Conversion::none:
            cut = cut_to_bits(column.field, from, count, scratch.data());
            break;
        case Conversion::widened:
            with_type(column.type, [&](auto to) {
                with_type(values.type(),
                          [&](auto source) { widen<decltype(to), decltype(source)>(from, numbers, scratch.data()); });
            });
            break;
        case Conversion::colours:
            for (std::size_t i = 0; i < numbers; ++i)
                store(scratch.data() + 2 * i, static_cast<std::uint16_t>(257u * std::to_integer<unsigned>(from[i])));
            break;
        case Conversion::rounded: {
            const bool colours = column.type == ScalarType::u16 && values.components() == 3 && is_float(values.type());
            with_type(column.type, [&](auto to) {
                put_rounded<decltype(to)>(column, values, first, count, colours, scratch.data());
            });
            break;
        }
    }
    scatter(column.field, scratch.data(), count, records, stride);
    return cut;
}

}  // namespace pcm::las
