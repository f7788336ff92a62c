// Attribute names that come out of files: made printable and unique before they enter a Schema.
#pragma once

#include "cloud/attribute.h"

#include <string>
#include <string_view>

namespace pcm {

// Cut at the first NUL, without blanks at the ends; control characters, and every byte beyond ASCII when the text is not
// valid UTF-8, become '_'. May be empty.
std::string printable_name(std::string_view raw);

// `name`, or `name` with "_2", "_3", ... when the schema has it already.
std::string unique_name(const Schema& schema, const std::string& name);

}  // namespace pcm
