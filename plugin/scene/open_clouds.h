// Trees that are open: layers that show the same one share its cloud.
#pragma once

#include "pcm/point_cloud.h"

#include <filesystem>
#include <memory>

namespace pcm::host {

// The tree at `path` (folder or index file). As long as somebody has its cloud, others get the same, and so the same
// cache, unless the tree was replaced in between. Throws what Tree::open throws. GUI thread.
std::shared_ptr<PointCloud> open_cloud(const std::filesystem::path& path);

}  // namespace pcm::host
