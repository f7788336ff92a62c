// Text that comes out of files and paths: made printable before it enters a Schema or a message.
#pragma once

#include "pcm/cloud/attribute.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace pcm {

// Cut at the first NUL, without blanks at the ends; control characters, and every byte beyond ASCII when the text is
// not valid UTF-8, become '_'. May be empty.
std::string printable_name(std::string_view raw);

// Bytes of a file in a form that can stand in a message: 'abc\x00', cut short after some dozens.
std::string quote_bytes(std::string_view bytes);

// `name`, or `name` with "_2", "_3", ... when the schema has it already.
std::string unique_name(const Schema& schema, const std::string& name);

// ASCII letters in lower case; other bytes stay.
std::string lower_case(std::string text);

// Of a path: lower case, without the dot; empty when there is none.
std::string extension_of(const std::filesystem::path& path);

}  // namespace pcm
