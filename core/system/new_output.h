// Files that are not to replace others unasked.
#pragma once

#include <filesystem>
#include <string>

namespace pcm {

// Throws Error(exists) for a file that exists, unless it may be replaced, and what output_file() throws.
void check_output(const std::filesystem::path& file, bool overwrite);
// Lower case, with its dot.
std::string lower_extension(const std::filesystem::path& file);
// A field of RFC 4180: in quotation marks where it needs them.
std::string csv_field(const std::string& text);

}  // namespace pcm
