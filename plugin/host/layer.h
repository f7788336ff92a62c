// Puts a cloud into a layer of MeshLab.
#pragma once

#include "host/registry.h"

#include <string>
#include <vector>

namespace pcm::host {

// Replaces the layer's contents by the proxy of `cloud` and registers the tie; views show the tree as soon as the
// document is not busy any more. Returns what the log should say. Errors: those of reading chunks, and of a cloud
// without points.
std::vector<std::string> show_tree(MeshModel& layer, const std::shared_ptr<PointCloud>& cloud);

// Replaces the layer's contents by all points of a file: for clouds that MeshLab can hold itself. Intensity becomes the
// quality of the vertices. Returns what the log should say. Errors: those of the reader; cancelled.
std::vector<std::string> load_points(MeshModel& layer, PointReader& reader, const ProgressFunction& progress);

}  // namespace pcm::host
