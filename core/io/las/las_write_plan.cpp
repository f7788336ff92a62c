#include "pcm/io/las/las_write_plan.h"

#include "pcm/cloud/attribute_length.h"
#include "pcm/cloud/with_type.h"
#include "pcm/io/las/las_layout.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

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
    Planner(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
        : path_(path), cloud_(cloud), survey_(options.survey.get())
    {
        plan_.target = choose_target(path, cloud, options);
        plan_.record_length = record_bytes[plan_.target.format];
        native_ = fields_of_format(plan_.target.format);
        for (std::size_t i = 0; i < cloud.schema.size(); ++i)
            if (const auto place = native_.schema.find(cloud.schema[i].name); place && !fits_field(i, *place))
                taken_.insert(exact_name(cloud.schema[i].name));
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
        add_scan_angle();
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

    std::optional<Conversion> fits_field(std::size_t i, std::size_t place) const
    {
        return exact_conversion(cloud_.schema[i], native_.schema[place], native_.fields[place].mask,
                                survey_ ? survey_->of(i) : nullptr);
    }

    std::string has_no_field(const Attribute& attribute, const Attribute& field) const
    {
        const std::string format = "point format " + std::to_string(plan_.target.format);
        if (attribute.type == field.type && attribute.components == field.components &&
            attribute.scale == field.scale && attribute.offset == field.offset)
            return "'" + attribute.name + "' needs more bits than " + format + " has for it: ";
        return "'" + attribute.name + "' is " + std::string(name_of(attribute.type)) +
               (attribute.components > 1 ? " x " + std::to_string(attribute.components) : "") + ", for which " +
               format + " has no field: ";
    }

    void into_field(std::size_t i, std::size_t place)
    {
        const Attribute& attribute = cloud_.schema[i];
        const Attribute& field = native_.schema[place];
        WriteColumn column;
        column.attribute = i;
        column.type = field.type;
        column.field = native_.fields[place];
        if (const auto exact = fits_field(i, place)) {
            column.conversion = *exact;
            plan_.columns.push_back(column);
            if (*exact == Conversion::colours)
                plan_.notes.push_back("colours of 8 bits are written with 16, times 257: 255 is 65535");
            return;
        }
        // Other software reads the field; our reader takes the exact values.
        const std::string kept = "extra bytes '" + exact_name(attribute.name) + "' keep it exactly";
        if (attribute.components == field.components) {
            column.conversion = Conversion::rounded;
            const std::string how = fit_to_field(column, attribute, field, survey_ ? survey_->of(i) : nullptr);
            plan_.columns.push_back(column);
            plan_.notes.push_back(has_no_field(attribute, field) + kept + ", and the field of that name has it " + how);
        } else {
            plan_.notes.push_back(has_no_field(attribute, field) + kept);
        }
        if (!attribute.description.empty() && attribute.description != exact_description)
            plan_.notes.push_back("the description of '" + attribute.name + "' is not kept");
        into_extra_bytes(i, exact_name(attribute.name), exact_description);
    }

    // Sets how the numbers go into a field that cannot hold them as they are, and says it.
    static std::string fit_to_field(WriteColumn& column, const Attribute& attribute, const Attribute& field,
                                    const ValueSurvey* known)
    {
        // As values, unless they are to fill the field's range.
        column.factor = attribute.scale / field.scale;
        column.addend = (attribute.offset - field.offset) / field.scale;
        const bool colours = attribute.name == attribute_name::rgb;
        const bool fills = column.type == ScalarType::u16 && (colours || attribute.name == attribute_name::intensity);
        if (column.field.mask) return "rounded, at most " + std::to_string(column.field.mask);
        if (!fills || (!known && !(colours && is_float(attribute.type)))) return "rounded";
        const double least = known && known->any() ? known->least : 0, most = known && known->any() ? known->most : 0;
        double factor = 0;
        if (is_float(attribute.type) && least >= 0 && most <= 1) factor = 65535;
        if (colours && factor == 0 && most <= 255) factor = 257;
        if (factor != 0) {
            column.factor = factor;
            column.addend = 0;
            return "times " + exact(factor) + ", rounded";
        }
        const bool stays = least >= 0 && most <= 65535 && (colours || known->whole || most >= 255);
        if (stays || !(least < most)) return "rounded";
        column.factor = 65535 / (most - least);
        column.addend = -least * column.factor;
        return "with its range, " + exact(least) + " to " + exact(most) + ", spread over 0 to 65535, rounded";
    }

    // Degrees, for the field that the other formats have for them.
    void add_scan_angle()
    {
        const bool extended = is_extended(plan_.target.format);
        const auto from = cloud_.schema.find(extended ? "scan_angle_rank" : "scan_angle");
        const char* const name = extended ? "scan_angle" : "scan_angle_rank";
        if (!from || cloud_.schema.find(name) || cloud_.schema[*from].components != 1) return;
        const std::size_t place = *native_.schema.find(name);
        WriteColumn column;
        column.attribute = *from;
        column.conversion = Conversion::rounded;
        column.type = native_.schema[place].type;
        column.field = native_.fields[place];
        column.factor = cloud_.schema[*from].scale / native_.schema[place].scale;
        column.addend = cloud_.schema[*from].offset / native_.schema[place].scale;
        plan_.columns.push_back(column);
    }

    void into_extra_bytes(std::size_t i, const std::string& name, const std::string& description)
    {
        const Attribute& attribute = cloud_.schema[i];
        const std::string text = shortened_description(description, most_name_bytes);
        if (text != description) plan_.notes.push_back("the description of '" + name + "' is cut to 32 bytes");
        const bool plain = is_plain_bytes(attribute) && attribute.components > 3 && attribute.components <= 255;
        const bool is_normal = is_written_as_normal(attribute);
        const bool one_descriptor = !is_normal && (attribute.components <= 3 || plain);
        const bool exact = description == exact_description && is_exact_name(name);
        // With room for the longest suffix of a component.
        const std::size_t suffix = one_descriptor ? 0 : component_name("", attribute.components - 1).size();
        const std::string short_name = is_normal || (exact && name.size() + suffix <= most_name_bytes)
                                           ? name
                                           : free_name(name, most_name_bytes - suffix);
        if (short_name != name)
            plan_.notes.push_back("'" + name + "' is written as '" + short_name +
                                  "': names have at most 32 bytes, and no two fields of a point have one");
        for (std::uint32_t c = 0; c < (one_descriptor ? 1u : attribute.components); ++c)
            add_descriptor(attribute,
                           one_descriptor ? short_name
                           : is_normal    ? free_name(normal_names[c], most_name_bytes)
                                          : component_name(short_name, c),
                           text, one_descriptor ? attribute.components : 1, plain);
        add_field(i, attribute.bytes());
    }

    // Three numbers of the names that other programs know, unless the cloud has those names, too.
    bool is_written_as_normal(const Attribute& attribute) const
    {
        const auto is_taken = [](const Attribute& other) {
            return is_normal_name(other.name, 0) || is_normal_name(other.name, 1) || is_normal_name(other.name, 2);
        };
        return attribute.name == attribute_name::normal && attribute.components == 3 &&
               std::none_of(cloud_.schema.begin(), cloud_.schema.end(), is_taken);
    }

    // Whether it is the name of the exact copy of a field.
    bool is_exact_name(const std::string& name) const
    {
        return std::any_of(native_.schema.begin(), native_.schema.end(),
                           [&](const Attribute& field) { return exact_name(field.name) == name; });
    }

    std::string free_name(const std::string& name, std::size_t most)
    {
        std::string candidate = cut_text(name, most);
        for (int number = 2; taken_.count(candidate) || is_name_of_a_field(plan_.target.format, candidate); ++number) {
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
    const Survey* survey_;
    WritePlan plan_;
    Fields native_;
    std::set<std::string> taken_;
    std::vector<std::byte> source_descriptors_;
};

template <class To>
void put_rounded(const WriteColumn& column, const Column& values, std::size_t first, std::size_t count,
                 std::byte* scratch)
{
    const std::uint32_t components = values.components();
    const double low = static_cast<double>(std::numeric_limits<To>::lowest());
    const double high = column.field.mask ? column.field.mask : static_cast<double>(std::numeric_limits<To>::max());
    for (std::size_t i = 0; i < count * components; ++i) {
        const double value = values.value(first + i / components, static_cast<std::uint32_t>(i % components));
        double rounded = value * column.factor + column.addend;
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

WritePlan plan_writing(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
{
    return Planner(path, cloud, options).plan();
}

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
        case Conversion::rounded:
            with_type(column.type,
                      [&](auto to) { put_rounded<decltype(to)>(column, values, first, count, scratch.data()); });
            break;
    }
    scatter(column.field, scratch.data(), count, records, stride);
    return cut;
}

}  // namespace pcm::las
