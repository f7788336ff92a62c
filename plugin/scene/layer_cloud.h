// The point cloud of a layer: its tree, and where its coordinates begin.
#pragma once

#include "pcm/point_cloud.h"

#include <memory>

namespace pcm::host {

class CachedTree;

struct LayerCloud {
    std::shared_ptr<PointCloud> cloud;
    Vec3d origin{};  // the scene's origin: source coordinates minus this are the coordinates of its views
    std::shared_ptr<const CachedTree> cached;  // the tree of a drawn copy; the last reference removes the tree's folder

    bool is_copy() const { return cached != nullptr; }
};

}  // namespace pcm::host
