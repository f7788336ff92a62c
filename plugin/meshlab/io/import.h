// Opens a point cloud in a layer: a small one completely, a large one through a tree.
#pragma once

#include "pcm/system/progress.h"
#include "plugin/scene/import_settings.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

class MeshModel;

namespace pcm::host {

// Receives the reasons why a cloud does not fit those that the document shows (scene/misfit.h), each once, before the
// layer changes. May throw, which ends the import.
using OnMisfit = std::function<void(const std::vector<std::string>& reasons)>;

// `path` is absolute: a tree folder, any file of a tree, or a file of any readable format. Returns lines for the log.
// Throws what readers, trees and the builder throw, and Error(cancelled).
std::vector<std::string> import_cloud(const std::filesystem::path& path, MeshModel& layer,
                                      const ImportSettings& settings, const ProgressFunction& progress,
                                      const OnMisfit& on_misfit);

}  // namespace pcm::host
