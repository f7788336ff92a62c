#include "pcm/io/text/text_fields.h"

#include "pcm/io/file_text.h"
#include "pcm/io/text/parse_number.h"

#include <algorithm>
#include <string>

namespace pcm {
namespace {

std::string_view trimmed(std::string_view word, char separator)
{
    while (!word.empty() && is_padding(word.front(), separator)) word.remove_prefix(1);
    while (!word.empty() && is_padding(word.back(), separator)) word.remove_suffix(1);
    return word;
}

// The end of a quoted field that begins at `at`: its closing quote. Two quotes inside mean one.
std::size_t closing_quote(std::string_view line, std::size_t at)
{
    const char quote = line[at];
    for (std::size_t i = at + 1; i < line.size(); ++i) {
        if (line[i] != quote) continue;
        if (i + 1 < line.size() && line[i + 1] == quote)
            ++i;
        else
            return i;
    }
    return std::string_view::npos;
}

}  // namespace

void split_fields(std::string_view line, const TextDialect& dialect, std::vector<std::string_view>& fields)
{
    fields.clear();
    const char separator = dialect.separator;
    const bool blanks = separator == ' ';
    bool behind_separator = false;
    for (std::size_t at = 0;;) {
        while (at < line.size() && (blanks ? text::is_blank(line[at]) : is_padding(line[at], separator))) ++at;
        if (at == line.size()) {
            if (behind_separator) fields.emplace_back();
            return;
        }
        std::size_t stop = at;
        const std::size_t close =
            line[at] == '"' || line[at] == '\'' ? closing_quote(line, at) : std::string_view::npos;
        if (close != std::string_view::npos) {
            stop = close + 1;
            if (!blanks)
                while (stop < line.size() && is_padding(line[stop], separator)) ++stop;
        }
        const auto ends = [&] {
            return stop == line.size() || (blanks ? text::is_blank(line[stop]) : line[stop] == separator);
        };
        if (close != std::string_view::npos && ends()) {
            fields.push_back(line.substr(at + 1, close - at - 1));
        } else {
            for (stop = at; !ends();) ++stop;
            fields.push_back(trimmed(line.substr(at, stop - at), separator));
        }
        behind_separator = !blanks && stop < line.size();
        at = stop + behind_separator;
    }
}

bool is_blank_or_comment(std::string_view line, char separator)
{
    while (!line.empty() && (text::is_blank(line.front()) || line.front() == '\v' || line.front() == '\f'))
        line.remove_prefix(1);
    if (line.empty() || line.front() == '%' || line.substr(0, 2) == "//") return true;
    if (line.front() == ';') return separator != ';';
    if (line.front() != '#') return false;
    for (const std::string_view value : {"#N/A", "#REF!", "#VALUE!", "#DIV/0!", "#NUM!", "#NAME?", "#NULL!"})
        if (line.substr(0, value.size()) == value) return false;
    return true;
}

bool is_no_data(std::string_view word)
{
    if (word.empty()) return false;
    for (const char sign : {'-', '*', '?'})
        if (word.find_first_not_of(sign) == std::string_view::npos) return true;
    if (word.size() > 8) return false;
    const std::string lower = lower_case(std::string(word));
    for (const std::string_view mark : {"na", "n/a", "#n/a", "null", "(null)", "none", "nil", "nodata", "no_data",
                                        "missing", "\\n", "#ref!", "#value!", "#div/0!", "#num!", "#name?", "#null!"})
        if (lower == mark) return true;
    return false;
}

FieldCounts count_fields(const std::vector<std::string_view>& fields, char point)
{
    FieldCounts counts;
    counts.fields = fields.size();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::string_view field = fields[i];
        double value;
        const bool missing = field.empty() || is_no_data(field);
        const bool number = !missing && text::parse_number(field, value, point);
        if (i == 0) counts.value_first = missing || number;
        counts.numbers += number;
        counts.missing += missing;
        counts.words += !missing && !number;
    }
    return counts;
}

}  // namespace pcm
