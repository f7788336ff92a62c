// A file of this machine or behind an address, by its name.
#pragma once

#include "pcm/system/byte_source.h"

#include <filesystem>
#include <memory>

namespace pcm {

// A URL (system/url.h) is opened without asking its server; a path is opened now, as File::Mode::read does it. Throws
// what File and RemoteFile throw.
std::shared_ptr<const ByteSource> open_bytes(const std::filesystem::path& path);

}  // namespace pcm
