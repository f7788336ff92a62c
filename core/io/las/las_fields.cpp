#include "pcm/io/las/las_fields.h"

#include "pcm/io/file_text.h"
#include "pcm/io/las/las_layout.h"
#include "pcm/io/unique_name.h"
#include "pcm/system/copy_strided.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

namespace pcm::las {
namespace {

void add(Fields& to, Attribute attribute, std::size_t offset)
{
    to.fields.push_back({offset, attribute.bytes(), 0, 0});
    to.schema.add(std::move(attribute));
}

void add(Fields& to, std::string name, ScalarType type, std::uint32_t components, std::size_t offset, double scale = 1)
{
    add(to, Attribute{std::move(name), type, components, scale, 0.0, {}}, offset);
}

void add_bits(Fields& to, std::string name, std::size_t offset, unsigned shift, unsigned mask)
{
    add(to, std::move(name), ScalarType::u8, 1, offset);
    to.fields.back().shift = shift;
    to.fields.back().mask = mask;
}

void add_wave_packet(Fields& to, std::size_t offset)
{
    add(to, "wave_packet_descriptor", ScalarType::u8, 1, offset);
    add(to, "wave_packet_offset", ScalarType::u64, 1, offset + 1);
    add(to, "wave_packet_size", ScalarType::u32, 1, offset + 9);
    add(to, "wave_return_location", ScalarType::f32, 1, offset + 13);
    add(to, "wave_direction", ScalarType::f32, 3, offset + 17);
}

void add_plain_bytes(Fields& to, std::size_t offset, std::size_t count)
{
    add(to, unique_name(to.schema, "extra_bytes"), ScalarType::u8, static_cast<std::uint32_t>(count), offset);
}

// One entry of the Extra Bytes VLR.
struct Descriptor {
    std::string name, description;
    ScalarType type = ScalarType::u8;
    std::uint32_t components = 0;
    std::array<double, 3> scale{1, 1, 1}, offset{0, 0, 0};
    bool plain = false;  // bytes without a described type

    std::size_t bytes() const { return size_of(type) * components; }
    // An attribute has a single scale and offset for all components.
    bool has_one_scale() const
    {
        for (std::size_t c = 1; !plain && c < components; ++c)
            if (scale[c] != scale[0] || offset[c] != offset[0]) return false;
        return true;
    }
};

class ExtraBytesPlan {
public:
    ExtraBytesPlan(const Header& header, std::vector<std::string>& notes)
        : notes_(notes),
          before_(fields_of_format(header.format)),
          base_(record_bytes[header.format]),
          extra_(header.record_length - base_)
    {
    }

    // `descriptions`: the values of all Extra Bytes VLRs. There should be one.
    Fields plan(const std::vector<std::vector<std::byte>>& descriptions)
    {
        if (descriptions.size() > 1 && plan_together(descriptions)) return std::move(result_);
        if (!descriptions.empty()) {
            result_ = before_;
            const std::string wrong = plan_described(descriptions[0]);
            if (wrong.empty()) return std::move(result_);
            add_note(notes_, "the Extra Bytes VLR is malformed (" + wrong + ")" +
                                 (extra_ ? "; the " + std::to_string(extra_) +
                                               " extra bytes of a point are kept as 'extra_bytes'"
                                         : "; the points have no extra bytes"));
        }
        result_ = before_;
        if (extra_) add_plain_bytes(result_, base_, extra_);
        return std::move(result_);
    }

private:
    bool plan_together(const std::vector<std::vector<std::byte>>& descriptions);
    std::optional<Descriptor> parse(const std::byte* from);
    std::string plan_described(const std::vector<std::byte>& bytes);
    std::size_t group_at(const std::vector<Descriptor>& list, std::size_t first) const;
    bool take_the_place_of_a_field(const Attribute& attribute, std::size_t offset);

    std::vector<std::string>& notes_;
    Fields before_, result_;
    std::size_t base_, extra_;
};

// Several VLRs describe the extra bytes one after the other, if they have that many; repetitions do not count.
bool ExtraBytesPlan::plan_together(const std::vector<std::vector<std::byte>>& descriptions)
{
    const std::string found =
        "the file has " + std::to_string(descriptions.size()) + " Extra Bytes VLRs, and LAS allows one; ";
    std::vector<std::byte> all = descriptions[0];
    for (std::size_t i = 1; i < descriptions.size(); ++i)
        if (descriptions[i] != descriptions[0]) all.insert(all.end(), descriptions[i].begin(), descriptions[i].end());
    if (all.size() == descriptions[0].size()) {
        add_note(notes_, found + "they are equal");
        return false;
    }
    result_ = before_;
    const std::string wrong = plan_described(all);
    add_note(notes_,
             found + (wrong.empty() ? "together they describe the extra bytes of a point"
                                    : "only the first is used, because together they are malformed (" + wrong + ")"));
    return wrong.empty();
}

// Nothing for an undefined data type.
std::optional<Descriptor> ExtraBytesPlan::parse(const std::byte* from)
{
    static constexpr ScalarType types[] = {ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16,
                                           ScalarType::u32, ScalarType::i32, ScalarType::u64, ScalarType::i64,
                                           ScalarType::f32, ScalarType::f64};
    const auto data_type = load<std::uint8_t>(from + extra::data_type);
    const auto options = load<std::uint8_t>(from + extra::options);
    if (data_type > 30) return std::nullopt;
    // The names of LAS 1.4: 1..10 scalars, 11..20 pairs and 21..30 triples of them (deprecated), 0 plain bytes.
    Descriptor d;
    d.plain = data_type == 0;
    d.type = d.plain ? ScalarType::u8 : types[(data_type - 1) % 10];
    d.components = d.plain ? options : (data_type - 1u) / 10 + 1;
    d.name = printable_name({reinterpret_cast<const char*>(from + extra::name), 32});
    if (d.name.empty()) d.name = "extra_bytes";
    d.description = printable_name({reinterpret_cast<const char*>(from + extra::description), 32});
    for (std::size_t c = 0; !d.plain && c < d.components; ++c) {
        if (options & extra::has_scale) d.scale[c] = load<double>(from + extra::scale + 8 * c);
        if (options & extra::has_offset) d.offset[c] = load<double>(from + extra::offset + 8 * c);
        if (!std::isfinite(d.scale[c]) || d.scale[c] == 0 || !std::isfinite(d.offset[c])) {
            add_note(notes_, "the scale or offset of the extra bytes '" + d.name +
                                 "' is NaN or infinite, or the scale is 0; ignored");
            d.scale[c] = 1;
            d.offset[c] = 0;
        }
    }
    return d;
}

// Whether descriptors can be components of one attribute.
bool match(const Descriptor& a, const Descriptor& b)
{
    return a.type == b.type && a.components == 1 && b.components == 1 && !a.plain && !b.plain &&
           a.scale[0] == b.scale[0] && a.offset[0] == b.offset[0];
}

// Whether the descriptors from `first` on are a normal, by the names that programs for LAS use.
bool is_normal_at(const std::vector<Descriptor>& list, std::size_t first)
{
    for (std::size_t c = 0; c < 3; ++c)
        if (first + c >= list.size() || !is_normal_name(list[first + c].name, c) ||
            !match(list[first + c], list[first]))
            return false;
    return true;
}

// How many descriptors from `first` on are components of one attribute; 1 when they are separate.
std::size_t ExtraBytesPlan::group_at(const std::vector<Descriptor>& list, std::size_t first) const
{
    if (is_normal_at(list, first)) return 3;
    const Descriptor& d = list[first];
    const std::string ending = "[0]";
    if (d.components != 1 || d.plain || d.name.size() <= ending.size() ||
        d.name.compare(d.name.size() - ending.size(), ending.size(), ending) != 0)
        return 1;
    const std::string name = d.name.substr(0, d.name.size() - ending.size());
    std::size_t count = 1;
    for (; first + count < list.size(); ++count) {
        const Descriptor& next = list[first + count];
        if (next.name != component_name(name, count) || !match(next, d) || next.description != d.description) break;
    }
    return count > 3 ? count : 1;
}

// Empty, or what is wrong with the VLR.
std::string ExtraBytesPlan::plan_described(const std::vector<std::byte>& bytes)
{
    if (bytes.size() % extra::descriptor_bytes != 0)
        return std::to_string(bytes.size()) + " bytes, a multiple of 192 was expected";
    std::vector<Descriptor> list;
    std::size_t described = 0;
    for (std::size_t start = 0; start < bytes.size(); start += extra::descriptor_bytes) {
        const auto descriptor = parse(bytes.data() + start);
        if (!descriptor)
            return "data type " + std::to_string(load<std::uint8_t>(bytes.data() + start + extra::data_type)) +
                   ", 0 to 30 are defined";
        if (descriptor->bytes() == 0) continue;
        if (descriptor->bytes() > extra_ - described)
            return "it describes more than the " + std::to_string(extra_) + " bytes that a point has";
        described += descriptor->bytes();
        list.push_back(*descriptor);
    }

    std::size_t used = 0;
    for (std::size_t i = 0; i < list.size();) {
        const Descriptor& d = list[i];
        const std::size_t group = group_at(list, i);
        const std::size_t pieces = d.has_one_scale() ? 1 : d.components;
        if (result_.schema.size() + pieces >= max_attributes) return "more attributes than can be kept";
        for (std::size_t piece = 0; piece < pieces; ++piece) {
            Attribute attribute;
            attribute.name = group == 3   ? std::string(attribute_name::normal)
                             : group > 1  ? d.name.substr(0, d.name.size() - 3)
                             : pieces > 1 ? component_name(d.name, piece)
                                          : d.name;
            attribute.type = d.type;
            attribute.components = group > 1 ? static_cast<std::uint32_t>(group) : pieces > 1 ? 1 : d.components;
            attribute.scale = d.plain ? 1 : d.scale[piece];
            attribute.offset = d.plain ? 0 : d.offset[piece];
            attribute.description = d.description;
            const std::size_t size = attribute.bytes();
            if (!take_the_place_of_a_field(attribute, base_ + used)) {
                attribute.name = unique_name(result_.schema, attribute.name);
                add(result_, std::move(attribute), base_ + used);
            }
            used += size;
        }
        i += group;
    }
    if (used < extra_) add_plain_bytes(result_, base_ + used, extra_ - used);
    return {};
}

bool ExtraBytesPlan::take_the_place_of_a_field(const Attribute& attribute, std::size_t offset)
{
    if (attribute.description != exact_description) return false;
    std::string name = attribute.name;
    const std::string ending = exact_name("");
    if (!before_.schema.find(name) && name.size() > ending.size() &&
        name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
        name.resize(name.size() - ending.size());
    const auto place = before_.schema.find(name);
    // Only once: the format's own field remains in the list.
    if (!place || result_.fields[*place].offset >= base_) return false;
    Schema schema;
    for (std::size_t i = 0; i < result_.schema.size(); ++i) {
        Attribute entry = i == *place ? attribute : result_.schema[i];
        if (i == *place) {
            entry.name = name;
            entry.description.clear();
        }
        schema.add(std::move(entry));
    }
    result_.schema = std::move(schema);
    result_.fields[*place] = {offset, attribute.bytes(), 0, 0};
    return true;
}

}  // namespace

Fields fields_of_format(unsigned format)
{
    Fields to;
    add(to, "intensity", ScalarType::u16, 1, 12);
    std::size_t next = 20;
    if (!is_extended(format)) {
        add_bits(to, "return_number", 14, 0, 7);
        add_bits(to, "number_of_returns", 14, 3, 7);
        add_bits(to, "scan_direction_flag", 14, 6, 1);
        add_bits(to, "edge_of_flight_line", 14, 7, 1);
        add_bits(to, "classification", 15, 0, 31);
        add_bits(to, "synthetic", 15, 5, 1);
        add_bits(to, "key_point", 15, 6, 1);
        add_bits(to, "withheld", 15, 7, 1);
        add(to, "scan_angle_rank", ScalarType::i8, 1, 16);
        add(to, "user_data", ScalarType::u8, 1, 17);
        add(to, "point_source_id", ScalarType::u16, 1, 18);
    } else {
        add_bits(to, "return_number", 14, 0, 15);
        add_bits(to, "number_of_returns", 14, 4, 15);
        add_bits(to, "synthetic", 15, 0, 1);
        add_bits(to, "key_point", 15, 1, 1);
        add_bits(to, "withheld", 15, 2, 1);
        add_bits(to, "overlap", 15, 3, 1);
        add_bits(to, "scanner_channel", 15, 4, 3);
        add_bits(to, "scan_direction_flag", 15, 6, 1);
        add_bits(to, "edge_of_flight_line", 15, 7, 1);
        add(to, "classification", ScalarType::u8, 1, 16);
        add(to, "user_data", ScalarType::u8, 1, 17);
        add(to, "scan_angle", ScalarType::i16, 1, 18, 0.006);
        add(to, "point_source_id", ScalarType::u16, 1, 20);
        next = 22;
    }
    if (has_gps_time(format)) {
        add(to, "gps_time", ScalarType::f64, 1, next);
        next += 8;
    }
    if (has_rgb(format)) {
        add(to, "rgb", ScalarType::u16, 3, next);
        next += 6;
    }
    if (has_nir(format)) {
        add(to, "nir", ScalarType::u16, 1, next);
        next += 2;
    }
    if (has_waves(format)) add_wave_packet(to, next);
    return to;
}

Fields fields_of_file(const Header& header, const std::vector<Vlr>& vlrs, std::vector<std::string>& notes)
{
    std::vector<std::vector<std::byte>> descriptions;
    for (const Vlr& vlr : vlrs)
        if (vlr.user_id == spec_user_id && vlr.id == extra_bytes_record_id) descriptions.push_back(vlr.value);
    return ExtraBytesPlan(header, notes).plan(descriptions);
}

bool is_normal_name(const std::string& name, std::size_t component)
{
    const std::string known = normal_names[component];
    return name.size() == known.size() && std::equal(name.begin(), name.end(), known.begin(), [](char a, char b) {
               return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
           });
}

std::string exact_name(const std::string& field) { return field + "_exact"; }

bool is_name_of_a_field(unsigned format, const std::string& name)
{
    // What laspy calls bytes of the record, where that is not the specification's name.
    static constexpr std::string_view any_format[] = {
        "X", "Y", "Z", "x", "y", "z", "bit_fields", "raw_classification", "classification_flags"};
    static constexpr std::string_view waves[] = {
        "wavepacket_index", "wavepacket_offset", "wavepacket_size", "return_point_wave_location", "x_t", "y_t", "z_t"};
    const auto is = [&](std::string_view other) { return name == other; };
    return fields_of_format(format).schema.find(name) ||
           std::any_of(std::begin(any_format), std::end(any_format), is) ||
           (has_rgb(format) && (is("red") || is("green") || is("blue"))) ||
           (has_waves(format) && std::any_of(std::begin(waves), std::end(waves), is));
}

std::string component_name(const std::string& name, std::size_t component)
{
    return name + "[" + std::to_string(component) + "]";
}

void gather(const Field& field, const std::byte* records, std::size_t stride, std::size_t count, std::byte* to)
{
    const std::byte* from = records + field.offset;
    if (field.mask) {
        for (std::size_t i = 0; i < count; ++i)
            to[i] = (from[i * stride] >> field.shift) & static_cast<std::byte>(field.mask);
        return;
    }
    copy_strided(field.bytes, from, stride, to, field.bytes, count);
}

void scatter(const Field& field, const std::byte* values, std::size_t count, std::byte* records, std::size_t stride)
{
    std::byte* to = records + field.offset;
    if (field.mask) {
        for (std::size_t i = 0; i < count; ++i)
            to[i * stride] |= (values[i] & static_cast<std::byte>(field.mask)) << field.shift;
        return;
    }
    copy_strided(field.bytes, values, field.bytes, to, stride, count);
}

}  // namespace pcm::las
