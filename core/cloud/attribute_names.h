// Attributes' names as people write them: which names new attributes can have, and how any name is written in a
// condition or an assignment.
//
// Files bring names of any kind: "1", "a=b", "x", "rgb[0]". Written as they are, such names could be read as numbers,
// relations, coordinates or components. In quotes, 'a=b' or "a=b", a name is that of an attribute and nothing else.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace pcm {

// A name as it stands at the beginning of a text.
struct WrittenName {
    std::string name;     // without quotes, and blanks around it
    bool quoted = false;  // the whole name
    std::size_t end = 0;  // end of the name in the text: what follows begins here
};

// In quotes, with an index in brackets behind them if there is one, or up to the first of the characters `ends` or the
// end of the text. Absent when a quote is not closed, or followed by something else than `ends`.
std::optional<WrittenName> written_name(std::string_view text, std::string_view ends);

// Whether a text is a number, NaN and infinity included.
bool is_number(std::string_view text);

// Throws Error(invalid_argument) for a name that a new attribute cannot have. It begins with a letter or _, and has
// letters, digits, _ - . and blanks between them; letters may be any of UTF-8. It is not a coordinate (x, y, z) or a
// number.
void check_new_name(const std::string& name);

}  // namespace pcm
