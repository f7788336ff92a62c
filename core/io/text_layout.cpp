#include "io/text_layout.h"

#include "cloud/error.h"

#include <algorithm>

namespace pcm {

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
    const auto count = [&](const char* wanted) { return std::count(columns.begin(), columns.end(), wanted); };
    for (const char* axis : {"x", "y", "z"})
        if (count(axis) != 1)
            throw Error(ErrorCode::invalid_argument, {},
                        "the columns '" + text + "' name " + axis + " " + std::to_string(count(axis)) + " times, not once",
                        "for example: x y z intensity r g b");
    for (const std::string& column : columns)
        if (column != "-" && count(column.c_str()) > 1)
            throw Error(ErrorCode::invalid_argument, {}, "the columns '" + text + "' name " + column + " more than once",
                        "a column that is not wanted is called -");
    return columns;
}

}  // namespace pcm
