// The names of columns in the lines before the first row of a text file.
#pragma once

#include "pcm/io/text/text_columns.h"
#include "pcm/io/text/text_fields.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

struct TextHeader {
    std::vector<TextColumn> columns;
    std::vector<std::string> names;  // as in the file, one per column
    bool geographic = false;         // x and y are longitude and latitude

    // Which names mean which columns, where they are not the same: "N→y, E→x"; empty when there are none.
    std::string renamed() const;
};

// The columns that a line names; null when it does not name x, y and z. Names may be separated as in the dialect or
// otherwise, quoted, after # or // or ;, in the words of text_names.h. Other names are kept.
std::optional<TextHeader> read_header(std::string_view line, const TextDialect& dialect);

// How many of x, y and z are named in a line that is not a whole header. For a clear error message.
std::size_t axes_named(std::string_view line, const TextDialect& dialect);

// The words of a line that seems to be a header of names that are not understood: as many as there are columns, most of
// them no values. Empty otherwise.
std::vector<std::string> unknown_names(std::string_view line, const TextDialect& dialect, std::size_t columns);

}  // namespace pcm
