#include "pcm/io/crs/coordinate_system.h"

#include "pcm/io/crs/crs_units.h"
#include "pcm/io/crs/geo_keys.h"
#include "pcm/io/crs/wkt.h"
#include "pcm/io/file_text.h"
#include "pcm/io/las_summary.h"

#include <charconv>
#include <cstdint>

namespace pcm {
namespace {

// A longer text is not a name: a definition for PROJ, a description.
constexpr std::size_t longest_name = 200;
constexpr std::string_view e57_key = "e57.coordinateMetadata";

std::string_view value_of(const Metadata& block)
{
    return {reinterpret_cast<const char*>(block.value.data()), block.value.size()};
}

// A VLR or EVLR of this user and record id, whatever its description.
bool is_record(std::string_view key, std::string_view user, unsigned id)
{
    for (const std::string_view list : {"las.vlr/", "las.evlr/"}) {
        if (key.substr(0, list.size()) != list) continue;
        key.remove_prefix(list.size());
        const std::string name = std::string(user) + "/" + std::to_string(id);
        return key.substr(0, name.size()) == name && (key.size() == name.size() || key[name.size()] == '/');
    }
    return false;
}

const Metadata* find(const std::vector<Metadata>& metadata, std::string_view user, unsigned id)
{
    for (const Metadata& block : metadata)
        if (is_record(block.key, user, id)) return &block;
    return nullptr;
}

// What `other` states of a part and `part` does not.
void complete(CrsPart& part, const CrsPart& other)
{
    if (part.name.empty()) part.name = other.name;
    if (!part.code && other.code) {
        part.code = other.code;
        part.authority = other.authority;
    }
    if (!part.unit.is_known()) part.unit = other.unit;
}

std::optional<CoordinateSystem> geotiff_of(const std::vector<Metadata>& metadata)
{
    const Metadata* const directory = find(metadata, "LASF_Projection", 34735);
    if (!directory) return {};
    const Metadata* const doubles = find(metadata, "LASF_Projection", 34736);
    const Metadata* const ascii = find(metadata, "LASF_Projection", 34737);
    return decode_geo_keys(directory->value, doubles ? doubles->value : std::vector<std::byte>(),
                           ascii ? ascii->value : std::vector<std::byte>());
}

std::optional<CoordinateSystem> wkt_of(const std::vector<Metadata>& metadata)
{
    for (const std::string_view user : {"LASF_Projection", "liblas"})
        if (const Metadata* block = find(metadata, user, 2112))
            if (auto system = decode_wkt(value_of(*block))) return system;
    return {};
}

std::optional<CoordinateSystem> las_system_of(const std::vector<Metadata>& metadata)
{
    auto keys = geotiff_of(metadata), text = wkt_of(metadata);
    if (!keys || !text) return keys ? keys : text;
    const auto header = first_las_summary(metadata);
    const bool text_counts = header && header->wkt_bit;
    CoordinateSystem& first = text_counts ? *text : *keys;
    CoordinateSystem& second = text_counts ? *keys : *text;
    if (compare(first, second) == CrsRelation::different) return first;
    complete(first.horizontal, second.horizontal);
    complete(first.vertical, second.vertical);
    if (first.name.empty()) first.name = second.name;
    if (first.kind == CrsKind::unknown) first.kind = second.kind;
    first.source += " and " + second.source;
    first.wkt = text->wkt;
    return first;
}

// Letters and digits in lower case, with the abbreviations of the EPSG register: ESRI's "WGS_1984_UTM_Zone_32N" and
// "WGS 84 / UTM zone 32N" are equal.
std::string plain_name(std::string_view name)
{
    std::string plain;
    for (const char c : lower_case(std::string(name)))
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80u) plain += c;
    for (const std::string_view year : {"1983", "1984", "1989", "1927", "1950", "1972"})
        if (const std::size_t at = plain.find(year); at != std::string::npos) plain.erase(at, 2);
    return plain;
}

CrsRelation compare(const CrsPart& a, const CrsPart& b)
{
    if (differ(a.unit, b.unit)) return CrsRelation::different;
    if (a.code && b.code && a.authority == b.authority)
        return a.code == b.code ? CrsRelation::same : CrsRelation::different;
    const bool only_units = !a.code && !b.code && a.name.empty() && b.name.empty() && a.unit.is_known();
    if (only_units && b.unit.is_known()) return CrsRelation::same;
    if (!a.name.empty() && plain_name(a.name) == plain_name(b.name)) return CrsRelation::same;
    if (a.code || b.code || a.name.empty() || b.name.empty()) return CrsRelation::unclear;
    return CrsRelation::different;
}

std::string describe(const CrsPart& part)
{
    std::string text = part.name;
    if (part.code) {
        const std::string code = part.authority + ":" + std::to_string(part.code);
        text += text.empty() ? code : " (" + code + ")";
    }
    if (part.unit.is_known()) text += (text.empty() ? "" : ", ") + part.unit.name;
    return text;
}

// "EPSG:32632" at the beginning of `text`, which is removed.
bool take_code(std::string_view& text, CrsPart& part)
{
    const std::size_t colon = text.find(':');
    if (colon == 0 || colon == std::string_view::npos || colon > 16) return false;
    for (const char c : text.substr(0, colon))
        if (!((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'))) return false;
    const auto [end, error] = std::from_chars(text.data() + colon + 1, text.data() + text.size(), part.code);
    if (error != std::errc() || part.code == 0) return false;
    for (const char c : text.substr(0, colon)) part.authority += static_cast<char>(c >= 'a' ? c - 'a' + 'A' : c);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
}

}  // namespace

std::string_view name_of(CrsKind kind)
{
    switch (kind) {
        case CrsKind::projected:
            return "projected";
        case CrsKind::geographic:
            return "geographic";
        case CrsKind::geocentric:
            return "geocentric";
        case CrsKind::local:
            return "local";
        case CrsKind::unknown:
            break;
    }
    return "unknown";
}

std::optional<CoordinateSystem> coordinate_system_of_text(std::string_view text, std::string_view source)
{
    const std::string printable = printable_name(text);
    if (printable.empty()) return {};
    if (auto system = decode_wkt(text)) {
        system->source = std::string(source) + ", WKT";
        return system;
    }
    CoordinateSystem system;
    system.source = source;
    std::string_view rest = printable;
    if (take_code(rest, system.horizontal) && !rest.empty() && rest[0] == '+') {
        system.vertical.authority = system.horizontal.authority;
        const auto [end, error] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), system.vertical.code);
        if (error == std::errc()) rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    }
    system.horizontal.name = printable_name(rest.substr(0, longest_name));
    system.name = system.horizontal.name;
    return system;
}

std::optional<CoordinateSystem> coordinate_system_of(const std::vector<Metadata>& metadata)
{
    if (auto system = las_system_of(metadata)) return system;
    for (const Metadata& block : metadata)
        if (block.key == e57_key)
            if (auto system = coordinate_system_of_text(value_of(block), "E57 coordinate metadata")) return system;
    for (const Metadata& block : metadata)
        if (block.key == crs_comment)
            if (auto system = coordinate_system_of_text(value_of(block), "comment")) return system;
    return {};
}

double metres_per_unit(const std::vector<Metadata>& metadata)
{
    const auto system = coordinate_system_of(metadata);
    const bool is_length = system && system->kind != CrsKind::geographic && system->horizontal.unit.is_known();
    return is_length ? system->horizontal.unit.per_unit : 1;
}

bool is_wkt_record(const Metadata& block) { return is_record(block.key, "LASF_Projection", 2112); }

bool is_geotiff_record(const Metadata& block)
{
    for (const unsigned id : {34735u, 34736u, 34737u})
        if (is_record(block.key, "LASF_Projection", id)) return true;
    return false;
}

bool is_crs_block(const Metadata& block)
{
    return is_geotiff_record(block) || is_wkt_record(block) || is_record(block.key, "LASF_Projection", 2111) ||
           is_record(block.key, "liblas", 2112) || block.key == e57_key || block.key == crs_comment;
}

std::string describe(const CoordinateSystem& system)
{
    std::string text = describe(system.horizontal);
    if (text.empty()) text = system.name.empty() ? std::string(name_of(system.kind)) + " coordinates" : system.name;
    if (const std::string heights = describe(system.vertical); !heights.empty()) text += "; heights " + heights;
    return text;
}

std::string crs_comment_line(const std::vector<Metadata>& metadata)
{
    const std::optional<CoordinateSystem> system = coordinate_system_of(metadata);
    if (!system) return {};
    std::string text;
    const CrsPart &horizontal = system->horizontal, &vertical = system->vertical;
    if (horizontal.code) {
        text = " " + horizontal.authority + ":" + std::to_string(horizontal.code);
        if (vertical.code && vertical.authority == horizontal.authority) text += "+" + std::to_string(vertical.code);
    }
    if (!system->name.empty()) text += " " + system->name.substr(0, longest_name);
    return text.empty() ? text : "crs:" + text;
}

std::optional<Metadata> crs_block_of_lines(const std::vector<std::string>& lines)
{
    for (const std::string& line : lines) {
        const std::size_t mark = line.find_first_not_of(" \t");
        if (mark == std::string::npos || (line[mark] != '#' && line[mark] != '%' && line.compare(mark, 2, "//") != 0))
            continue;
        const std::size_t word = line.find_first_not_of("#%/ \t", mark);
        if (word == std::string::npos || lower_case(line.substr(word, 4)) != "crs:") continue;
        const std::string text = printable_name(std::string_view(line).substr(word + 4));
        if (text.empty()) continue;
        const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
        return Metadata{crs_comment, {bytes, bytes + text.size()}};
    }
    return {};
}

CrsRelation compare(const CoordinateSystem& a, const CoordinateSystem& b)
{
    const bool kinds_known = a.kind != CrsKind::unknown && b.kind != CrsKind::unknown;
    if (kinds_known && a.kind != b.kind) return CrsRelation::different;
    if (!a.wkt.empty() && !b.wkt.empty() && compact_wkt(a.wkt) == compact_wkt(b.wkt)) return CrsRelation::same;
    const CrsRelation flat = compare(a.horizontal, b.horizontal);
    if (flat == CrsRelation::different) return flat;
    if (!a.vertical.is_known() && !b.vertical.is_known()) return flat;
    if (!a.vertical.is_known() || !b.vertical.is_known()) return CrsRelation::unclear;
    const CrsRelation heights = compare(a.vertical, b.vertical);
    return heights == CrsRelation::same ? flat : heights;
}

}  // namespace pcm
