// Names for results, next to the cloud that they are made of. Any thread.
#pragma once

#include <filesystem>
#include <string>

namespace pcm::host {

// A path next to `cloud`, whose name without extension is that of the cloud and `ending` ("-normals.pct"): NAME-normals
// for NAME and for NAME-normals itself. A number is added where there is something of this name. In the user's home
// where the cloud's folder cannot be written.
std::filesystem::path free_path(const std::filesystem::path& cloud, const std::string& ending);

}  // namespace pcm::host
