// Text that comes from files and their names: made printable before it enters a Schema or a message.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pcm {

// `raw` up to the first NUL, without blanks at the ends; control characters, and every byte beyond ASCII when the text
// is not valid UTF-8, become '_'. May be empty.
std::string printable_name(std::string_view raw);

// Bytes of a file, quoted for a message: 'abc\x00'; cut after some dozens.
std::string quote_bytes(std::string_view bytes);

// ASCII letters in lower case; other bytes stay.
std::string lower_case(std::string text);

// The extension of a path in lower case, without the dot; empty when there is none.
std::string extension_of(const std::filesystem::path& path);

}  // namespace pcm
