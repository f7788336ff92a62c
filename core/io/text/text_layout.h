// How the lines of a text file are split into columns: detected from the file, or stated by the user.
#pragma once

#include "pcm/cloud/attribute.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Unset members are detected.
struct TextLayout {
    // ' ' stands for any run of blanks and tabs; ',' ';' '\t' separate single fields, which may be empty or quoted.
    std::optional<char> separator;
    // Lines before the first point; a header among them names the columns unless `columns` does.
    std::optional<std::size_t> skip_lines;
    // What the columns are, from the left: "x" "y" "z" are required once each; "r" "g" "b" become rgb, "nx" "ny" "nz"
    // normal; "-" is not read; any other name is an attribute of that name ("intensity", "classification", ...). A type
    // may follow a name: "intensity:f64"; types are i8 u8 i16 u16 i32 u32 i64 u64 f32 f64.
    std::vector<std::string> columns;
    // Maximum value of a colour in the file: 1, 255 or 65535.
    std::optional<double> colour_range;
};

// Columns as users write them: names separated by blanks or commas, "x y z intensity r g b".
// Throws Error(invalid_argument) with what is wrong with the text.
std::vector<std::string> parse_columns(const std::string& text);

// One of TextLayout::columns: its name, and the type after a colon. Throws Error(invalid_argument) for an unknown
// type.
struct NamedColumn {
    std::string name;
    std::optional<ScalarType> type;
};
NamedColumn named_column(const std::string& column);

// "blanks", "commas", "semicolons" or "tabs".
std::string name_of_separator(char separator);

// A layout for people: "x y z r g b (colours 0-255), separated by blanks, 2 lines skipped". Unset members are
// left out.
std::string describe(const TextLayout& layout);

// Checks a user's layout. Throws Error(invalid_argument) for values that TextLayout does not allow.
void check_layout(const TextLayout& layout);

}  // namespace pcm
