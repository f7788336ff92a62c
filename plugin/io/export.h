// Writes a layer to a file: all of the tree that it stands for, or its vertices; in source coordinates.
#pragma once

#include "pcm/system/progress.h"

#include <common/interfaces.h>

#include <filesystem>
#include <string>
#include <vector>

namespace pcm::host {

// Whether we write this layer although MeshLab has an exporter for the extension: its own would write the proxy of a
// tree, and the positions of a cloud without the document's origin. Layers with faces or edges are MeshLab's.
bool is_ours_to_write(const MeshModel& layer);

// What can be chosen in the dialog; depends on the layer and the format.
void add_export_settings(RichParameterList& parameters, const std::string& extension, const MeshModel& layer);

// What of MeshLab's own members a vertex can be written with (vcg::tri::io::Mask).
int export_mask();

// `mask` is what the user has ticked; it matters for layers that stand for no tree. Returns what the log should say.
// Errors: those of the reader and the writer; cancelled. On an error nothing is left behind.
std::vector<std::string> export_layer(const std::filesystem::path& path, const MeshModel& layer, int mask,
                                      const RichParameterList& parameters, const ProgressFunction& progress);

}  // namespace pcm::host
