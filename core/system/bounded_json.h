// JSON of files that anybody may have written.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace pcm {

// The value that `text` states. The text is looked through before anything is kept of it: values, names and texts that
// would take more than 128 MB of memory, and lists and objects more than 32 deep in each other, are refused. Throws
// Error(bad_format) for those, and for what is not JSON, with the line and column.
nlohmann::ordered_json parse_bounded_json(const std::string& text);

}  // namespace pcm
