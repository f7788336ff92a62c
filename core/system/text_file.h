// Small text files that people give: lists, camera paths, pairs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace pcm {

// The bytes of a file of at most `most_bytes`, which a message calls `what`: "a list of measures". A FIFO, a device or
// a folder is refused without waiting for it, and a longer file before memory is taken for it. Throws Error(bad_format)
// for a longer file, and what File throws.
std::string read_text_file(const std::filesystem::path& file, const std::string& what, std::uint64_t most_bytes);

}  // namespace pcm
