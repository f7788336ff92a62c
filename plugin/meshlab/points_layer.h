// Loads a small cloud into an ordinary layer of MeshLab, with all points and attributes.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/system/progress.h"
#include "plugin/meshlab/registry.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// Replaces the layer's contents with all points of a file. If the file has more than `most_points`, leaves the layer
// unchanged and returns nothing. Positions are relative to the document's origin. Colours, normals, intensity (as
// quality) and radius become vertex members, all other attributes per-vertex attributes; layer_source.h says how values
// are kept that float cannot hold. `on_box`, if any, is called with the box of the points before the layer changes; it
// may throw. Returns lines for the log. Throws what the reader throws, and Error(cancelled).
std::optional<std::vector<std::string>> load_points(MeshModel& layer, PointReader& reader, std::uint64_t most_points,
                                                    const ProgressFunction& progress,
                                                    const std::function<void(const Box3d&)>& on_box = {});

}  // namespace pcm::host
