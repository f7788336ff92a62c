// A tree in a layer of MeshLab; points_layer.h has the clouds that a layer holds whole.
#pragma once

#include "plugin/host/registry.h"

#include <string>
#include <vector>

namespace pcm::host {

// Replaces the layer's contents by the proxy of `cloud` and registers the tie; views show the tree as soon as the
// document is not busy any more. Returns what the log should say. Errors: those of reading chunks, and of a cloud
// without points.
std::vector<std::string> show_tree(MeshModel& layer, const std::shared_ptr<PointCloud>& cloud);

// Empties the layer and unties it from a tree or a file; whether it is visible stays.
void clear_layer(MeshModel& layer);

// For the log: how MeshLab's coordinates and the source's belong together, and what float makes of positions in `box`.
std::string origin_line(const Vec3d& origin);
std::string rounding_line(const Box3d& box, const Vec3d& origin, const char* what);

}  // namespace pcm::host
