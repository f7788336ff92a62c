// Opens a point cloud in a layer: a small one completely, a large one through a tree.
#pragma once

#include "pcm/system/progress.h"
#include "plugin/io/import_settings.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pcm::host {

// `path` is absolute: a tree folder, any file of a tree, or a file of any readable format. Returns lines for the log.
// Throws what readers, trees and the builder throw, and Error(cancelled).
std::vector<std::string> import_cloud(const std::filesystem::path& path, MeshModel& layer,
                                      const ImportSettings& settings, const ProgressFunction& progress);

}  // namespace pcm::host
