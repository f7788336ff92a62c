// Writes a layer to a file in source coordinates: the tree that it shows, or its vertices.
#pragma once

#include "pcm/system/progress.h"
#include "plugin/scene/parameters.h"

#include <filesystem>
#include <string>
#include <vector>

class MeshModel;

namespace pcm::host {

// Whether this plugin writes the layer even if MeshLab has an exporter for the extension: MeshLab's would write the
// proxy of a tree, and the positions of a cloud without the document's origin. MeshLab writes layers with faces or
// edges.
bool is_ours_to_write(const MeshModel& layer);

// The parameters of the dialog for this layer and format.
void add_export_settings(Parameters& parameters, const std::string& extension, const MeshModel& layer);

// The vertex members that can be written (vcg::tri::io::Mask).
int export_mask();

// `mask` has the members that the user has ticked; it is ignored for layers that show a tree. Returns lines for the
// log. Throws what the reader and the writer throw, and Error(cancelled). On an error no file is left.
std::vector<std::string> export_layer(const std::filesystem::path& path, const MeshModel& layer, int mask,
                                      const Parameters& parameters, const ProgressFunction& progress);

}  // namespace pcm::host
