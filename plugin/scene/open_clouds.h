// Trees that are open: layers that show the same one share its cloud.
#pragma once

#include "pcm/point_cloud.h"

#include <filesystem>
#include <memory>

namespace pcm::host {

// The tree at `path` (folder or index file). As long as somebody has its cloud, others get the same, and so the same
// cache, unless the tree was replaced in between. Throws what Tree::open throws. GUI thread.
std::shared_ptr<PointCloud> open_cloud(const std::filesystem::path& path);

// What open_cloud() gives the cache of a cloud.
L2Options cache_of_opened();

// While it lives, open_cloud() of the cloud's tree gives this cloud: one that a thread has opened, so that the GUI
// thread does not wait for a server. One at a time. GUI thread.
class OpenedAlready {
public:
    explicit OpenedAlready(std::shared_ptr<PointCloud> cloud);
    ~OpenedAlready();
    OpenedAlready(const OpenedAlready&) = delete;
    OpenedAlready& operator=(const OpenedAlready&) = delete;
};

}  // namespace pcm::host
