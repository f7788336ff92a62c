// Opens a point cloud in a layer: all of it when it is small, by way of a tree when it is large.
#pragma once

#include "pcm/system/progress.h"
#include "plugin/io/import_settings.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pcm::host {

// `path` is absolute: a tree folder, an index file, or a file of any readable format. Returns what the log should say.
// Errors: those of readers, trees and the builder; cancelled.
std::vector<std::string> import_cloud(const std::filesystem::path& path, MeshModel& layer,
                                      const ImportSettings& settings, const ProgressFunction& progress);

}  // namespace pcm::host
