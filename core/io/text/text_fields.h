// Lines of text files as fields: numbers, marks of missing values, words.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace pcm {

// How a line is split into fields.
struct TextDialect {
    char separator =
        ' ';           // ' ': any run of blanks and tabs; otherwise ',' ';' '\t', and fields may be padded and quoted
    char point = '.';  // decimal point
    bool operator==(const TextDialect& o) const { return separator == o.separator && point == o.point; }
};

inline bool is_padding(char c, char separator) { return (c == ' ' || c == '\t') && c != separator; }

// Fields without padding and quotes. A separator at the end of a line is followed by one more, empty field.
void split_fields(std::string_view line, const TextDialect& dialect, std::vector<std::string_view>& fields);

// An empty line, or one that begins with # // % or ; (not where ; separates fields). An error value of a spreadsheet
// (#N/A) does not begin a comment.
bool is_blank_or_comment(std::string_view line, char separator = ' ');

// A word that stands for a missing value, in any case: NA, N/A, #N/A, null, none, nil, nodata, missing, -, *, ?, \N,
// also repeated signs. NaN is a number.
bool is_no_data(std::string_view word);

// What the fields of a line are.
struct FieldCounts {
    std::size_t fields = 0, numbers = 0;
    std::size_t missing = 0;   // empty, or is_no_data()
    std::size_t words = 0;     // anything else
    bool value_first = false;  // the first field is a number or missing

    // Whether the line is a row of data, perhaps a faulty one, of a file of `columns` columns, rather than a title or
    // the names of columns.
    bool like_a_row(std::size_t columns) const
    {
        return fields >= 2 && numbers && (numbers + missing) * 2 > fields && (fields == columns || value_first);
    }
};
FieldCounts count_fields(const std::vector<std::string_view>& fields, char point);

}  // namespace pcm
