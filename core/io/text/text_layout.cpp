#include "pcm/io/text/text_layout.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <string_view>

namespace pcm {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

void check_columns(const std::vector<std::string>& columns)
{
    std::string text;
    std::vector<std::string> names;
    for (const std::string& column : columns) {
        text += (text.empty() ? "" : " ") + column;
        names.push_back(named_column(column).name);
    }
    const auto count = [&](const char* wanted) { return std::count(names.begin(), names.end(), wanted); };
    for (const char* axis : {"x", "y", "z"})
        if (count(axis) != 1)
            refuse("the columns '" + text + "' name " + axis + " " + std::to_string(count(axis)) + " times, not once",
                   "for example: x y z intensity r g b");
    for (const std::string& name : names)
        if (name != "-" && count(name.c_str()) > 1)
            refuse("the columns '" + text + "' name " + name + " more than once", "name a column - to skip it");
}

}  // namespace

NamedColumn named_column(const std::string& column)
{
    const std::size_t colon = column.rfind(':');
    if (colon == std::string::npos) return {column, std::nullopt};
    const std::string_view wanted = std::string_view(column).substr(colon + 1);
    for (int t = static_cast<int>(ScalarType::i8); t <= static_cast<int>(ScalarType::f64); ++t)
        if (name_of(static_cast<ScalarType>(t)) == wanted && colon > 0)
            return {column.substr(0, colon), static_cast<ScalarType>(t)};
    refuse("the column '" + column + "' has no known type after its colon",
           "types are i8 u8 i16 u16 i32 u32 i64 u64 f32 f64, for example: intensity:f64");
}

std::vector<std::string> parse_columns(const std::string& text)
{
    std::vector<std::string> columns;
    std::string name;
    for (const char c : text + " ") {
        if (c != ' ' && c != ',' && c != '\t' && c != '\n') {
            name += c;
        } else if (!name.empty()) {
            columns.push_back(name);
            name.clear();
        }
    }
    check_columns(columns);
    return columns;
}

std::string name_of_separator(char separator)
{
    return separator == ',' ? "commas" : separator == ';' ? "semicolons" : separator == '\t' ? "tabs" : "blanks";
}

std::string describe(const TextLayout& layout)
{
    std::string text;
    for (const std::string& column : layout.columns) text += (text.empty() ? "" : " ") + column;
    if (layout.colour_range) text += " (colours 0-" + exact(*layout.colour_range) + ")";
    if (layout.separator) text += ", separated by " + name_of_separator(*layout.separator);
    if (const std::size_t lines = layout.skip_lines.value_or(0))
        text += ", " + grouped(lines) + (lines == 1 ? " line skipped" : " lines skipped");
    return text;
}

void check_layout(const TextLayout& layout)
{
    if (layout.separator && std::string_view(" ,;\t").find(*layout.separator) == std::string_view::npos)
        refuse("the separator '" + std::string(1, *layout.separator) + "' is not known",
               "separators are a blank, a comma, a semicolon and a tab");
    if (layout.colour_range && *layout.colour_range != 1 && *layout.colour_range != 255 &&
        *layout.colour_range != 65535)
        refuse("colours up to " + exact(*layout.colour_range) + " are not known", "the range is 1, 255 or 65535");
    if (!layout.columns.empty()) check_columns(layout.columns);
}

}  // namespace pcm
