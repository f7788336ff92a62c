// Text that comes from files and their names: made printable before it enters a Schema or a message.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pcm {

// Cut at the first NUL, without blanks at the ends; control characters, and every byte beyond ASCII when the text is
// not valid UTF-8, become '_'. May be empty.
std::string printable_name(std::string_view raw);

// Bytes of a file in a form that can stand in a message: 'abc\x00', cut short after some dozens.
std::string quote_bytes(std::string_view bytes);

// ASCII letters in lower case; other bytes stay.
std::string lower_case(std::string text);

// Of a path: lower case, without the dot; empty when there is none.
std::string extension_of(const std::filesystem::path& path);

}  // namespace pcm
