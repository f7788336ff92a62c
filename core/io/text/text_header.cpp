#include "pcm/io/text/text_header.h"

#include "pcm/io/file_text.h"
#include "pcm/io/text/parse_number.h"
#include "pcm/io/text/text_names.h"

#include <algorithm>
#include <array>

namespace pcm {
namespace {

constexpr auto no_position = static_cast<std::size_t>(-1);

std::string unquoted(std::string_view word)
{
    std::string text;
    for (std::size_t i = 0; i < word.size(); ++i) {
        text += word[i];
        if (word[i] == '"' && i + 1 < word.size() && word[i + 1] == '"') ++i;
    }
    return as_utf8(text);
}

// Without the comment marks before it.
std::string_view behind_marks(std::string_view line)
{
    const std::size_t at = line.find_first_not_of(" \t#/%;");
    return at == std::string_view::npos ? std::string_view() : line.substr(at);
}

bool is_number(std::string_view word)
{
    double value = 0;
    return text::parse_number(word, value) && word.find_first_of("0123456789") != word.npos;
}

// The columns of x, y and z among names; no_column where there is none.
struct Axes {
    std::array<std::size_t, 3> columns = {no_position, no_position, no_position};
    bool geographic = false;

    std::size_t count() const
    {
        return 3 - static_cast<std::size_t>(std::count(columns.begin(), columns.end(), no_position));
    }
};

Axes axes_of(const std::vector<std::string>& names)
{
    using Kind = AxisName::Kind;
    Axes best;
    for (const Kind kind : {Kind::plain, Kind::projected, Kind::geographic}) {
        Axes axes;
        axes.geographic = kind == Kind::geographic;
        std::array<unsigned, 3> ranks = {~0u, ~0u, ~0u};
        for (std::size_t i = 0; i < names.size(); ++i) {
            const auto named = axis_name(names[i]);
            if (!named || (named->axis < 2 && named->kind != kind) || named->rank >= ranks[named->axis]) continue;
            ranks[named->axis] = named->rank;
            axes.columns[named->axis] = i;
        }
        if (axes.count() > best.count()) best = axes;
    }
    return best;
}

// The names in a line, split by the separator that finds most names among x, y and z.
std::vector<std::string> names_of(std::string_view line, const TextDialect& dialect)
{
    const bool comment = is_blank_or_comment(line, dialect.separator);
    std::vector<std::string> best;
    std::size_t best_axes = 0;
    std::vector<std::string_view> words;
    for (const char separator : {dialect.separator, ',', ';', '\t', ' '}) {
        split_fields(comment ? behind_marks(line) : line, {separator, '.'}, words);
        if (!words.empty() && words.back().empty()) words.pop_back();
        std::vector<std::string> names;
        std::size_t numbers = 0;
        for (const std::string_view word : words) {
            // A unit behind a name: "X [m] Y [m] Z [m]".
            const bool unit = word.size() > 2 && ((word.front() == '[' && word.back() == ']') ||
                                                  (word.front() == '(' && word.back() == ')'));
            if (separator == ' ' && unit && !names.empty()) continue;
            names.push_back(unquoted(word));
            numbers += is_number(names.back());
        }
        // A year may name a column; in a comment numbers are values.
        if (numbers * 2 >= names.size() || (comment && numbers)) continue;
        const std::size_t axes = axes_of(names).count();
        if (axes > best_axes) {
            best_axes = axes;
            best = names;
        }
    }
    return best;
}

// Words for colours and normals mean them only where all three are named.
void keep_only_whole_groups(std::vector<TextColumn>& columns, const std::vector<std::string>& names)
{
    for (const auto& members : {std::array{"r", "g", "b"}, std::array{"nx", "ny", "nz"}}) {
        std::array<std::size_t, 3> at;
        for (std::size_t k = 0; k < 3; ++k)
            at[k] = static_cast<std::size_t>(
                std::find_if(columns.begin(), columns.end(),
                             [&](const TextColumn& column) { return column.name == members[k]; }) -
                columns.begin());
        if (std::find(at.begin(), at.end(), columns.size()) == at.end()) continue;
        for (const std::size_t i : at)
            if (i < columns.size() && own_meaning(names[i]).empty()) columns[i].name.clear();
    }
}

}  // namespace

std::string TextHeader::renamed() const
{
    std::string text;
    for (std::size_t i = 0; i < columns.size(); ++i)
        if (!names[i].empty() && columns[i].name != "-" && bare_name(names[i]) != bare_name(columns[i].name))
            text += (text.empty() ? "" : ", ") + printable_name(names[i]) + "→" + columns[i].name;
    return text;
}

std::optional<TextHeader> read_header(std::string_view line, const TextDialect& dialect)
{
    TextHeader header;
    header.names = names_of(line, dialect);
    const std::vector<std::string>& names = header.names;
    const Axes axes = axes_of(names);
    if (axes.count() < 3) return std::nullopt;
    header.geographic = axes.geographic;
    std::vector<TextColumn>& columns = header.columns;
    columns.resize(names.size());
    for (std::size_t a = 0; a < 3; ++a) columns[axes.columns[a]].name = std::string(1, "xyz"[a]);
    const auto taken = [&](std::string_view name) {
        return std::any_of(columns.begin(), columns.end(), [&](const TextColumn& c) { return c.name == name; });
    };
    for (const auto meaning_of : {own_meaning, other_meaning})
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (!columns[i].name.empty()) continue;
            const std::string_view meaning = meaning_of(names[i]);
            if (meaning.empty() || taken(meaning)) continue;
            columns[i].name = meaning;
            const std::string bare = bare_name(names[i]);
            columns[i].float_colour = bare == "rf" || bare == "gf" || bare == "bf";
        }
    keep_only_whole_groups(columns, names);
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!columns[i].name.empty()) continue;
        const std::string own = printable_name(names[i]);
        std::string name = own.empty() || own == "-" ? "column_" + std::to_string(i + 1) : own;
        for (int number = 2; taken(name); ++number) name = own + "_" + std::to_string(number);
        columns[i].name = name;
    }
    return header;
}

std::size_t axes_named(std::string_view line, const TextDialect& dialect)
{
    return axes_of(names_of(line, dialect)).count();
}

std::vector<std::string> unknown_names(std::string_view line, const TextDialect& dialect, std::size_t columns)
{
    std::vector<std::string_view> words;
    for (const char separator : {dialect.separator, ',', ';', '\t'}) {
        split_fields(line, {separator, dialect.point}, words);
        if (words.size() == columns + 1 && words.back().empty()) words.pop_back();
        const FieldCounts counts = count_fields(words, dialect.point);
        if (counts.fields != columns || counts.words * 2 < counts.fields) continue;
        std::vector<std::string> names;
        for (const std::string_view word : words) names.push_back(printable_name(unquoted(word)));
        return names;
    }
    return {};
}

}  // namespace pcm
