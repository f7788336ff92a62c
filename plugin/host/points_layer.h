// A cloud of moderate size as an ordinary layer of MeshLab, all its points and attributes.
#pragma once

#include "pcm/system/progress.h"
#include "plugin/host/registry.h"
#include "pcm/io/reader.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// Replaces the layer's contents by all points of a file; when there are more than `most_points`, leaves the layer as it
// is and returns nothing. Positions are relative to the document's origin; colours, normals, intensity (as quality) and
// radius go where MeshLab has them, everything else into per-vertex attributes; see layer_source.h for what float
// cannot hold. Returns what the log should say. Errors: those of the reader; cancelled.
std::optional<std::vector<std::string>> load_points(MeshModel& layer, PointReader& reader, std::uint64_t most_points,
                                                    const ProgressFunction& progress);

}  // namespace pcm::host
