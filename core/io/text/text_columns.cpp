#include "pcm/io/text/text_columns.h"

#include "pcm/io/file_text.h"
#include "pcm/io/unique_name.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

// The letters and digits of a name, in lower case: "GPS Time [s]" -> "gpstime".
std::string skeleton(std::string_view name)
{
    name = name.substr(0, name.find_first_of("[("));
    std::string bare;
    for (const char c : name) {
        if (c >= 'A' && c <= 'Z') bare += static_cast<char>(c - 'A' + 'a');
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) bare += c;
    }
    if (bare.size() > 6 && bare.substr(0, 6) == "scalar") bare.erase(0, 6);  // CloudCompare's scalar fields
    return bare;
}

struct Synonym {
    std::string_view name, meaning;
};
constexpr Synonym synonyms[] = {
    {"easting", "x"},
    {"east", "x"},
    {"coordx", "x"},
    {"xcoord", "x"},
    {"xcoordinate", "x"},
    {"pointx", "x"},
    {"longitude", "x"},
    {"lon", "x"},
    {"northing", "y"},
    {"north", "y"},
    {"coordy", "y"},
    {"ycoord", "y"},
    {"ycoordinate", "y"},
    {"pointy", "y"},
    {"latitude", "y"},
    {"lat", "y"},
    {"elevation", "z"},
    {"elev", "z"},
    {"height", "z"},
    {"altitude", "z"},
    {"alt", "z"},
    {"coordz", "z"},
    {"zcoord", "z"},
    {"zcoordinate", "z"},
    {"pointz", "z"},
    {"red", "r"},
    {"colorred", "r"},
    {"colourred", "r"},
    {"diffusered", "r"},
    {"rf", "r"},
    {"green", "g"},
    {"colorgreen", "g"},
    {"colourgreen", "g"},
    {"diffusegreen", "g"},
    {"gf", "g"},
    {"blue", "b"},
    {"colorblue", "b"},
    {"colourblue", "b"},
    {"diffuseblue", "b"},
    {"bf", "b"},
    {"normalx", "nx"},
    {"xnormal", "nx"},
    {"normx", "nx"},
    {"normaly", "ny"},
    {"ynormal", "ny"},
    {"normy", "ny"},
    {"normalz", "nz"},
    {"znormal", "nz"},
    {"normz", "nz"},
    {"i", "intensity"},
    {"class", "classification"},
    {"returnno", "return_number"},
    {"numreturns", "number_of_returns"},
    {"returncount", "number_of_returns"},
    {"infrared", "nir"},
    {"nearinfrared", "nir"},
};

// Attributes that LAS defines, and the types it gives them.
struct Known {
    std::string_view name;
    ScalarType type;
};
constexpr Known known_attributes[] = {
    {"classification", ScalarType::u8},
    {"return_number", ScalarType::u8},
    {"number_of_returns", ScalarType::u8},
    {"scan_direction_flag", ScalarType::u8},
    {"edge_of_flight_line", ScalarType::u8},
    {"synthetic", ScalarType::u8},
    {"key_point", ScalarType::u8},
    {"withheld", ScalarType::u8},
    {"overlap", ScalarType::u8},
    {"scanner_channel", ScalarType::u8},
    {"scan_angle_rank", ScalarType::i8},
    {"user_data", ScalarType::u8},
    {"point_source_id", ScalarType::u16},
    {"gps_time", ScalarType::f64},
    {"nir", ScalarType::u16},
};

constexpr std::string_view meanings_apart[] = {"x",  "y",  "z",  "r",         "g",         "b",
                                               "nx", "ny", "nz", "intensity", "scan_angle"};

// The meaning whose own name this is, whatever its case and signs; empty when no meaning has it.
std::string_view own_meaning(std::string_view bare)
{
    for (const std::string_view meaning : meanings_apart)
        if (bare == skeleton(meaning)) return meaning;
    for (const Known& known : known_attributes)
        if (bare == skeleton(known.name)) return known.name;
    return {};
}

std::string_view other_meaning(std::string_view bare)
{
    for (const Synonym& synonym : synonyms)
        if (bare == synonym.name) return synonym.meaning;
    return {};
}

std::string unquoted(std::string_view word)
{
    std::string text;
    for (std::size_t i = 0; i < word.size(); ++i) {
        text += word[i];
        if (word[i] == '"' && i + 1 < word.size() && word[i + 1] == '"') ++i;
    }
    return printable_name(text);
}

// Without the comment marks before it.
std::string_view behind_marks(std::string_view line)
{
    const std::size_t at = line.find_first_not_of(" \t#/%");
    return at == std::string_view::npos ? std::string_view() : line.substr(at);
}

bool is_number(std::string_view word)
{
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && stop == word.data() + word.size() && word.find_first_of("0123456789") != word.npos;
}

// The names in a line, split by the separator that finds the most of x, y and z.
std::vector<std::string> names_of(std::string_view line, const TextDialect& dialect)
{
    std::vector<std::string> best;
    std::size_t best_axes = 0;
    std::vector<std::string_view> words;
    for (const char separator : {dialect.separator, ',', ';', '\t', ' '}) {
        split_fields(behind_marks(line), {separator, '.'}, words);
        if (!words.empty() && words.back().empty()) words.pop_back();
        std::size_t axes = 0;
        std::vector<std::string> names;
        for (const std::string_view word : words) {
            names.push_back(unquoted(word));
            if (is_number(names.back())) axes = 0, names.clear();  // a number is not a name
            if (names.empty()) break;
            const std::string bare = skeleton(names.back());
            const std::string_view meaning = own_meaning(bare).empty() ? other_meaning(bare) : own_meaning(bare);
            axes += meaning == "x" || meaning == "y" || meaning == "z";
        }
        if (axes > best_axes) {
            best_axes = axes;
            best = names;
        }
    }
    return best;
}

ColumnLook merged(const std::vector<const ColumnLook*>& looks)
{
    ColumnLook all = *looks[0];
    for (std::size_t i = 1; i < looks.size(); ++i) {
        const ColumnLook& o = *looks[i];
        all.values += o.values;
        all.empty += o.empty;
        all.least = std::min(all.least, o.least);
        all.most = std::max(all.most, o.most);
        all.whole = all.whole && o.whole;
        all.digits_only = all.digits_only && o.digits_only;
        all.fits_i64 = all.fits_i64 && o.fits_i64;
        all.fits_u64 = all.fits_u64 && o.fits_u64;
        all.beyond_double = all.beyond_double || o.beyond_double;
        all.single = all.single && o.single;
        all.digits = std::max(all.digits, o.digits);
    }
    return all;
}

bool fits(const ColumnLook& look, ScalarType type)
{
    if (look.values == 0 && look.empty == 0) return true;  // a file without points
    switch (type) {
        case ScalarType::i8:
            return look.whole && look.within(-128, 127);
        case ScalarType::u8:
            return look.whole && look.within(0, 255);
        case ScalarType::i16:
            return look.whole && look.within(-32768, 32767);
        case ScalarType::u16:
            return look.whole && look.within(0, 65535);
        default:
            return true;
    }
}

ScalarType smallest_float(const ColumnLook& look) { return look.single ? ScalarType::f32 : ScalarType::f64; }

ScalarType type_of(std::string_view name, const ColumnLook& look, bool signed_intensity)
{
    // Numbers of eight digits and more are not all floats as printed by accident.
    const bool from_floats = look.single && look.digits >= 8 && !look.whole;
    if (name == attribute_name::normal) return smallest_float(look);
    if (name == attribute_name::intensity) {
        // Zeros written as 0.0000 are meant as floats.
        if (!look.whole || !look.digits_only) return smallest_float(look);
        if (signed_intensity && fits(look, ScalarType::i16)) return ScalarType::i16;
        if (fits(look, ScalarType::u16)) return ScalarType::u16;
        if (fits(look, ScalarType::i16)) return ScalarType::i16;
    }
    for (const Known& known : known_attributes)
        if (name == known.name && fits(look, known.type)) return known.type;
    if (look.whole && look.beyond_double && look.fits_i64) return ScalarType::i64;
    if (look.whole && look.beyond_double && look.fits_u64) return ScalarType::u64;
    return from_floats ? ScalarType::f32 : ScalarType::f64;
}

// The type of colours, null where the numbers are not colours.
std::optional<ScalarType> colour_type(const ColumnLook& look, std::optional<double> range, bool float_colours)
{
    if (range) return *range == 255 ? ScalarType::u8 : *range == 65535 ? ScalarType::u16 : smallest_float(look);
    if (float_colours && look.within(0, 1)) return smallest_float(look);
    if (fits(look, ScalarType::u8)) return ScalarType::u8;
    if (fits(look, ScalarType::u16)) return ScalarType::u16;
    if (!look.whole && !look.empty && look.within(0, 1)) return smallest_float(look);
    return std::nullopt;
}

// base and k of "base_k"; k has no leading zeros.
std::optional<std::pair<std::string, std::uint32_t>> component_name(const std::string& name)
{
    const std::size_t underscore = name.rfind('_');
    if (underscore == std::string::npos || underscore == 0 || underscore + 1 == name.size()) return std::nullopt;
    const std::string digits = name.substr(underscore + 1);
    if (digits.size() > 4 || digits.find_first_not_of("0123456789") != std::string::npos ||
        (digits.size() > 1 && digits[0] == '0'))
        return std::nullopt;
    return std::pair(name.substr(0, underscore), static_cast<std::uint32_t>(std::stoul(digits)));
}

// Columns that together are one attribute.
struct Group {
    std::string attribute;
    std::vector<std::size_t> columns;  // by component
};

constexpr std::size_t no_column = static_cast<std::size_t>(-1);

std::vector<Group> find_groups(const std::vector<TextColumn>& columns)
{
    const auto find = [&](std::string_view name) {
        for (std::size_t i = 0; i < columns.size(); ++i)
            if (columns[i].name == name) return i;
        return no_column;
    };
    std::vector<Group> groups;
    for (const auto& [attribute, members] : {std::pair{attribute_name::rgb, std::array{"r", "g", "b"}},
                                             {attribute_name::normal, std::array{"nx", "ny", "nz"}}}) {
        Group group{std::string(attribute), {find(members[0]), find(members[1]), find(members[2])}};
        if (std::find(group.columns.begin(), group.columns.end(), no_column) == group.columns.end())
            groups.push_back(std::move(group));
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto first = component_name(columns[i].name);
        if (!first || first->second != 0) continue;
        Group group{first->first, {i}};
        for (std::size_t at = i;
             (at = find(group.attribute + "_" + std::to_string(group.columns.size()))) != no_column;)
            group.columns.push_back(at);
        // Not where another attribute has the name.
        bool free = find(group.attribute) == no_column;
        for (const Group& other : groups) free = free && other.attribute != group.attribute;
        if (group.columns.size() > 1 && free) groups.push_back(std::move(group));
    }
    return groups;
}

// The type of a group's attribute: as the user stated it, else by the sampled values of all of its columns. Null for
// colours whose numbers are not colours.
std::optional<ScalarType> group_type(const Group& group, const std::vector<TextColumn>& columns,
                                     const std::vector<ColumnLook>& looks, std::optional<double> colour_range,
                                     bool signed_intensity)
{
    std::vector<const ColumnLook*> members;
    std::optional<ScalarType> stated;
    bool float_colours = false;
    for (const std::size_t c : group.columns) {
        members.push_back(&looks[c]);
        if (columns[c].type) stated = std::max(stated.value_or(ScalarType::i8), *columns[c].type);
        float_colours = float_colours || columns[c].float_colour;
    }
    if (stated) return stated;
    const ColumnLook look = merged(members);
    if (group.attribute == attribute_name::rgb) return colour_type(look, colour_range, float_colours);
    return type_of(group.attribute, look, signed_intensity);
}

}  // namespace

std::optional<std::vector<TextColumn>> header_columns(const std::string& line, const TextDialect& dialect)
{
    const std::vector<std::string> names = names_of(line, dialect);
    std::vector<TextColumn> columns(names.size());
    const auto taken = [&](std::string_view name) {
        return std::any_of(columns.begin(), columns.end(), [&](const TextColumn& c) { return c.name == name; });
    };
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string_view meaning = own_meaning(skeleton(names[i]));
        if (!meaning.empty() && !taken(meaning)) columns[i].name = meaning;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!columns[i].name.empty()) continue;
        const std::string bare = skeleton(names[i]);
        const std::string_view meaning = other_meaning(bare);
        if (meaning.empty() || taken(meaning)) continue;
        columns[i].name = meaning;
        columns[i].float_colour = bare == "rf" || bare == "gf" || bare == "bf";
    }
    for (const char* axis : {"x", "y", "z"})
        if (!taken(axis)) return std::nullopt;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (columns[i].name.empty()) {
            std::string name = names[i].empty() || names[i] == "-" ? "column_" + std::to_string(i + 1) : names[i];
            for (int number = 2; taken(name); ++number) name = names[i] + "_" + std::to_string(number);
            columns[i].name = name;
        }
    return columns;
}

bool is_half_a_header(const std::string& line, const TextDialect& dialect)
{
    std::size_t axes = 0;
    for (const std::string& name : names_of(line, dialect)) {
        const std::string_view meaning = own_meaning(skeleton(name));
        axes += meaning == "x" || meaning == "y" || meaning == "z";
    }
    return axes >= 2;
}

std::vector<TextColumn> guess_columns(const std::vector<ColumnLook>& looks, std::uint64_t rows)
{
    const std::size_t count = looks.size();
    std::vector<TextColumn> columns(count);
    for (std::size_t i = 0; i < std::min<std::size_t>(3, count); ++i) columns[i].name = std::string(1, "xyz"[i]);
    const auto free = [&](std::size_t start) {
        return start + 2 < count && columns[start].name.empty() && columns[start + 1].name.empty() &&
               columns[start + 2].name.empty();
    };
    const auto name_three = [&](std::size_t start, const std::array<const char*, 3>& names) {
        for (std::size_t k = 0; k < 3; ++k) columns[start + k].name = names[k];
    };
    for (std::size_t s = 3; free(s); ++s) {
        const ColumnLook& look = looks[s];
        const std::uint64_t odd = rows - look.unit_vectors - look.null_vectors;
        if (odd > rows / 50 || look.unit_vectors * 2 < rows) continue;
        name_three(s, {"nx", "ny", "nz"});
        break;
    }
    const auto left = [&] {
        return std::count_if(columns.begin(), columns.end(), [](const TextColumn& c) { return c.name.empty(); });
    };
    const auto colours_at = [&](std::size_t s, double most, bool whole) {
        if (!free(s)) return false;
        bool fractions = false;
        for (std::size_t k = s; k < s + 3; ++k) {
            if (!looks[k].within(0, most) || looks[k].empty || (whole && !looks[k].whole)) return false;
            fractions = fractions || !looks[k].whole;
        }
        return whole || fractions;
    };
    const auto find_colours = [&](double most, bool whole) {
        // Of four remaining columns the first is the intensity.
        std::size_t first = count, second = count;
        for (std::size_t s = 3; s < count; ++s)
            if (colours_at(s, most, whole)) {
                second = first == count ? count : std::min(second, s);
                first = std::min(first, s);
            }
        if (first == count) return false;
        name_three(left() == 4 && second == first + 1 ? second : first, {"r", "g", "b"});
        return true;
    };
    if (!find_colours(255, true) && left() <= 4 && !find_colours(1, false)) find_colours(65535, true);
    const bool one_left = left() == 1;
    for (std::size_t i = 0; i < count; ++i)
        if (columns[i].name.empty()) columns[i].name = one_left ? "intensity" : "column_" + std::to_string(i + 1);
    return columns;
}

TextPlan plan_columns(const std::vector<TextColumn>& columns, const std::vector<ColumnLook>& looks,
                      std::optional<double> colour_range, bool signed_intensity)
{
    TextPlan plan;
    plan.fields.resize(columns.size());
    const std::vector<Group> groups = find_groups(columns);
    std::vector<std::size_t> group_of(columns.size(), no_column);
    std::vector<ScalarType> type_of_group(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const auto type = group_type(groups[g], columns, looks, colour_range, signed_intensity);
        if (!type) {
            plan.notes.push_back(
                "the columns r g b hold neither whole numbers up to 65535 nor fractions up to 1, and are kept as three "
                "attributes without colour");
            continue;
        }
        if (groups[g].attribute == attribute_name::rgb)
            plan.colour_range = *type == ScalarType::u8 ? 255 : *type == ScalarType::u16 ? 65535 : 1;
        type_of_group[g] = *type;
        for (const std::size_t c : groups[g].columns) group_of[c] = g;
    }

    for (std::size_t c = 0; c < columns.size(); ++c) {
        const std::string& name = columns[c].name;
        TextField& field = plan.fields[c];
        field.name = name;
        if (name == "-") continue;
        if (name == "x" || name == "y" || name == "z") {
            field.role = TextField::Role::axis;
            field.index = static_cast<std::size_t>(name[0] - 'x');
            continue;
        }
        field.role = TextField::Role::attribute;
        const std::size_t g = group_of[c];
        const std::string& attribute = g == no_column ? name : groups[g].attribute;
        if (g != no_column) {
            const auto& members = groups[g].columns;
            field.component =
                static_cast<std::uint32_t>(std::find(members.begin(), members.end(), c) - members.begin());
            field.type = type_of_group[g];
            if (const auto there = plan.schema.find(attribute)) {
                field.index = *there;
                continue;
            }
        } else {
            field.type = columns[c].type ? *columns[c].type : type_of(name, looks[c], signed_intensity);
        }
        field.index = plan.schema.size();
        // Names that mean three components are not given to one.
        const bool misleading = g == no_column && (name == attribute_name::rgb || name == attribute_name::normal);
        const std::string unique = unique_name(plan.schema, misleading ? name + "_scalar" : attribute);
        plan.schema.add(
            {unique, field.type, g == no_column ? 1u : static_cast<std::uint32_t>(groups[g].columns.size()), 1, 0, {}});
    }
    return plan;
}

}  // namespace pcm
