#include "pcm/io/text/text_columns.h"

#include "pcm/io/unique_name.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

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
    for (const KnownAttribute& known : known_attributes)
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
    std::vector<std::size_t> columns;  // one per component
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
        // The first of four remaining columns is the intensity.
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
