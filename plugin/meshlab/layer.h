// Shows a tree in a layer of MeshLab. points_layer.h loads small clouds into a layer completely.
#pragma once

#include "plugin/meshlab/registry.h"
#include "plugin/scene/proxy.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pcm::host {

// Replaces the layer's contents with the proxy of `cloud` (proxy.h) and attaches the cloud to the layer. Views show the
// tree as soon as the document is not busy any more. Returns lines for the log. Throws what reading chunks throws, and
// Error(bad_format) for a cloud without points.
std::vector<std::string> show_tree(MeshModel& layer, const std::shared_ptr<PointCloud>& cloud);

// The layers of the document that show the tree `folder` are loaded again; one whose tree has lost all points becomes
// empty. Returns a line for each. Throws what opening the tree and reading chunks throws.
std::vector<std::string> reload_layers(MeshDocument& document, const std::filesystem::path& folder);

// A sample's positions plus this are MeshLab's, of a layer that shows it: zero where both have the document's origin.
Vec3d shift_of(const Proxy& sample);
ScalarPosition shifted(const std::array<float, 3>& position, const Vec3d& shift);

// Replaces the layer's mesh with the vertices of a sample.
void fill_with_sample(MeshModel& layer, const Proxy& sample);

// Makes MeshLab's views take the changed vertices. Does nothing without a window.
void vertices_changed(MeshModel& layer);

// Empties the layer and detaches it from its tree or file. Its visibility is kept.
void clear_layer(MeshModel& layer);

// For the log: the relation of MeshLab's coordinates to source coordinates, and the rounding of positions in `box` to
// float.
std::string origin_line(const Vec3d& origin);
std::string rounding_line(const Box3d& box, const Vec3d& origin, const char* what);

}  // namespace pcm::host
